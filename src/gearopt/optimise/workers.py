"""Processes of this machine that run a slow text at several points at once.

They are for texts that are run point by point; what a method asks for together is shared out. One
that has not ended when the run does is ended.
"""

import multiprocessing
import pickle
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, NamedTuple

from gearopt.errors import SolveError

PAUSE = 0.05  # s between two looks at the time that is left
_problem: Any = None  # of a worker


class Workers(NamedTuple):
    """The processes of a run, and the problem whose text they know."""

    pool: ProcessPoolExecutor
    problem: Any

    def know(self, problem: Any) -> bool:
        """Whether a problem has the text that they know, at the same parameters."""
        own = self.problem
        texts = (
            (p.evaluate, *(v for r in p.repeats for v in (r.evaluate, r.data)))
            for p in (own, problem)
        )
        same = all(a is b for a, b in zip(*texts, strict=False))
        return (
            same
            and len(own.repeats) == len(problem.repeats)
            and own.parameters == problem.parameters
        )


_WORKERS: ContextVar[Workers | None] = ContextVar("processes of the run", default=None)


@contextmanager
def working(problem: Any, count: int) -> Iterator[None]:
    """Have so many processes run the text of a problem within; 1: this process alone.

    They are forked, and know the text as it is. Where processes cannot be forked it must be a
    function that others can import: SolveError.
    """
    if count == 1:
        yield
        return
    forked = "fork" in multiprocessing.get_all_start_methods()
    if not forked:
        _check_importable(problem)
    before = set(multiprocessing.active_children())
    context = multiprocessing.get_context("fork" if forked else None)
    pool = ProcessPoolExecutor(count, context, initializer=_begin, initargs=(problem,))
    token = _WORKERS.set(Workers(pool, problem))
    try:
        pool.submit(int).result()  # all of them begin, before this process has threads
        yield
    finally:
        _WORKERS.reset(token)
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - before:
            child.kill()
            child.join()


def shared_out(
    problem: Any,
    work: Callable[..., Any],
    tasks: Sequence[tuple[Any, ...]],
    late: Callable[[], bool],
) -> Iterator[Any] | None:
    """Results of work(problem, *task) in order, by processes that know the problem; None: by none.

    They end where no time is left, but for one.
    """
    workers = _WORKERS.get()
    if workers is None or len(tasks) < 2 or not workers.know(problem):
        return None
    futures = [workers.pool.submit(_work, work, task) for task in tasks]
    return _in_order(futures, late)


def _in_order(futures: Sequence[Future[Any]], late: Callable[[], bool]) -> Iterator[Any]:
    for k, future in enumerate(futures):
        while not future.done():
            if k and late():
                for left in futures[k:]:
                    left.cancel()
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


def _work(work: Callable[..., Any], task: tuple[Any, ...]) -> Any:
    return work(_problem, *task)


def _check_importable(problem: Any) -> None:
    try:
        pickle.dumps(problem)
    except Exception as refused:
        raise SolveError(
            f"workers need a text that other processes can import: write the one of {problem.name} "
            "as a function of a module, or leave workers out"
        ) from refused
