"""Best-first search: order, ties, and nodes that a refusal leaves open."""

from gearopt.optimise.best_first import best_first, ending


def test_the_least_bound_is_branched_next_and_ties_in_order():
    """A child may have a lower bound than its parent; equal bounds are taken as they came."""
    children = {"": ["b", "a", "c"], "a": ["d"], "b": ["e"]}
    bounds = {"a": 1.0, "b": 1.0, "c": 0.5, "d": 1.0, "e": 2.0}
    taken = []

    def branch(_, name):
        taken.append(name)
        return ((bounds[child], child) for child in children.get(name, ()))

    left = best_first([(0.0, "")], lambda *_: True, branch)
    assert taken == ["", "c", "b", "a", "d", "e"]
    assert left.waiting == [] and left.least == float("inf")


def test_a_refused_node_stays_open():
    """Its bound is that of all that is left, whatever was pushed before."""
    asked = []

    def goes_on(bound, node):
        asked.append((bound, node))
        return bound < 3.0

    left = best_first([(1.0, 1)], goes_on, lambda bound, k: [(bound + 1.0, 2 * k), (9.0, k)])
    assert asked == [(1.0, 1), (2.0, 2), (3.0, 4)]
    assert left.least == 3.0 and [node for _, _, node in sorted(left.waiting)] == [4, 1, 2]


def test_what_a_search_leaves_is_told_in_plain_words():
    assert ending(True) == "none is left to examine"
    assert ending(False) == "stopped before all were examined"
