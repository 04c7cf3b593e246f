"""The iteration of conjugate gradients on bounded multipliers: what it promises, and the same text run by Python."""

import numpy as np
from scipy.sparse import csr_array

from dincl.solvers.dual import bounded_conjugate_gradients


def test_the_iteration_keeps_its_word_and_counts():
    matrix = csr_array([[1.0, 0.0], [0.6, 0.8], [-1.0, 0.0]])
    least, mu = np.array([1.0, 1.2, -3.0]), np.zeros(3)
    arrays = matrix.indptr, matrix.indices, matrix.data, 2, least
    iterations, residual = bounded_conjugate_gradients(*arrays, mu, 100, 1e-12)
    dense = matrix.toarray()
    assert 0 < iterations <= 6
    assert residual <= 1e-12
    assert np.abs(np.minimum(mu, dense @ dense.T @ mu - least)).max() < 1e-12
    again = mu.copy()
    assert bounded_conjugate_gradients(*arrays, again, 100, 1e-11)[0] == 0
    assert (again == mu).all()
    cut = np.zeros(3)
    assert bounded_conjugate_gradients(*arrays, cut, 1, 1e-12)[0] == 1
    assert (cut >= 0).all()
