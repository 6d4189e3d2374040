"""Processes of this machine that run a slow text at several points at once.

They are for texts that are run point by point; what a method asks for together is shared out. One
that has not ended when the run does is ended.
"""

import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

from gearopt.errors import SolveError
from gearopt.frozen import dataclass

if TYPE_CHECKING:
    from concurrent.futures import Future, ProcessPoolExecutor
    from multiprocessing.process import BaseProcess

PAUSE = 0.05  # s between two looks at the time that is left
_problem: Any = None  # of a worker


@dataclass
class Workers:
    """The processes of a run; it has state because they begin with the first text they are for."""

    count: int
    pool: "ProcessPoolExecutor | None" = None
    problem: Any = None
    children: "tuple[BaseProcess, ...]" = ()

    def of(self, problem: Any) -> "ProcessPoolExecutor":
        """Processes that know the text of a problem; begun anew where they know another one."""
        if self.pool is None or not _same_text(self.problem, problem):
            self.end()
            self.begin(problem)
        assert self.pool is not None
        return self.pool

    def begin(self, problem: Any) -> None:
        """Fork them, so that any text goes; where that is impossible, it must be importable."""
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        forked = "fork" in multiprocessing.get_all_start_methods()
        if not forked:
            _check_importable(problem)
        before = set(multiprocessing.active_children())
        context = multiprocessing.get_context("fork" if forked else None)
        self.pool = ProcessPoolExecutor(
            self.count, context, initializer=_begin, initargs=(problem,)
        )
        self.problem = problem
        self.pool.submit(int).result()
        self.children = tuple(set(multiprocessing.active_children()) - before)

    def end(self) -> None:
        """End them, whatever they do."""
        if self.pool is not None:
            self.pool.shutdown(wait=False, cancel_futures=True)
        for child in self.children:
            child.kill()
            while child.is_alive():  # as it seems until the pool, which may reap it first, knows
                child.join(PAUSE)
        self.pool, self.children = None, ()


_WORKERS: ContextVar[Workers | None] = ContextVar("processes of the run", default=None)


@contextmanager
def working(count: int) -> Iterator[None]:
    """Have so many processes run slow texts within; 1: this process alone."""
    workers = Workers(count) if count > 1 else None
    token = _WORKERS.set(workers)
    try:
        yield
    finally:
        _WORKERS.reset(token)
        if workers is not None:
            workers.end()


def shared_out(
    problem: Any,
    work: Callable[..., Any],
    tasks: Sequence[tuple[Any, ...]],
    late: Callable[[], bool],
) -> Iterator[Any] | None:
    """Results of work(problem, *task) in order, by processes; None where the run has none.

    They end where no time is left, but for one.
    """
    workers = _WORKERS.get()
    if workers is None or len(tasks) < 2:
        return None
    pool = workers.of(problem)
    values = {q.name: q.value for q in problem.parameters}
    return _in_order([pool.submit(_work, work, values, task) for task in tasks], late)


def _in_order(futures: "Sequence[Future[Any]]", late: Callable[[], bool]) -> Iterator[Any]:
    for k, future in enumerate(futures):
        while not future.done():
            if k and late():
                for waiting in futures[k:]:
                    waiting.cancel()
                return
            try:
                future.exception(timeout=PAUSE)
            except TimeoutError:
                continue
        yield future.result()


def _begin(problem: Any) -> None:
    global _problem
    _problem = problem
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the run itself ends them


def _work(work: Callable[..., Any], values: dict[str, Any], task: tuple[Any, ...]) -> Any:
    return work(_problem.at(**values), *task)


def _same_text(own: Any, other: Any) -> bool:
    """Whether two problems differ in bounds and numbers alone."""
    texts = [
        (p.evaluate, *(part for r in p.repeats for part in (r.evaluate, r.data)))
        for p in (own, other)
    ]
    return len(texts[0]) == len(texts[1]) and all(a is b for a, b in zip(*texts, strict=True))


def _check_importable(problem: Any) -> None:
    try:
        pickle.dumps(problem)
    except Exception as refused:
        raise SolveError(
            f"workers need a text that other processes can import: write the one of {problem.name} "
            "as a function of a module, or leave workers out"
        ) from refused
