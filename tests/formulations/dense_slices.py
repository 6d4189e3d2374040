"""The compliance matrix of slices, written out: what `share_slices` never needs."""

import numpy as np


def matrix(springs):
    """C (n m, n m) [mm/N] of one position, pairs of teeth one after the other."""
    count, slices = springs.contacts.shape
    whole = np.diag(springs.contacts.ravel()) + springs.coupling
    for k in range(count):
        links = springs.links[k]
        rows = np.diag(springs.bed[k] + np.append(links, 0.0) + np.append(0.0, links))
        rows = rows - np.diag(links, 1) - np.diag(links, -1)
        some = slice(k * slices, (k + 1) * slices)
        whole[some, some] += np.linalg.inv(rows)
    return whole
