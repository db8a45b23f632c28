"""Operation counts: of algorithms that give the right numbers, and as the document has them."""

import re
from pathlib import Path

import numpy as np
import pytest
from formulation_arms import furnished, relative

from robomech_ros.dynamics.formulations.complexity import (
    ALGORITHMS,
    Counted,
    Operations,
    operation_counts,
    plain_links,
)
from robomech_ros.dynamics.formulations.lagrange import inverse_dynamics_by_lagrange
from robomech_ros.dynamics.formulations.orthogonal_complement import natural_orthogonal_complement
from robomech_ros.dynamics.formulations.plain_recursions import (
    cholesky_solution,
    composite_inertia,
    newton_euler,
    orthogonal_complement_inertia,
)
from robomech_ros.errors import BadValueError
from robomech_ros.robots import chain_from_dh

PAGE = Path(__file__).resolve().parents[3] / "doc" / "dynamics_formulations.md"


def test_the_counted_algorithms_give_torques_and_mass_matrix():
    rng = np.random.default_rng(3)
    a, b, alpha, q, qd, qdd = rng.uniform(-1.5, 1.5, (6, 7))
    # Bodies are given in frame i + 1 here, as the recursions have them.
    bodies = furnished(chain_from_dh(a, b, alpha), 4).bodies
    arm = chain_from_dh(a, b, alpha, bodies=bodies)
    rows = [[one.mass, *one.com, *one.inertia[np.triu_indices(3)]] for one in bodies]
    links = plain_links(a, b, alpha, q, np.array(rows))
    gravity = [1.0, 2.0, -9.0]
    tau = newton_euler(links, qd, qdd, gravity)
    assert relative(tau, inverse_dynamics_by_lagrange(arm, q, qd, qdd, gravity=gravity)) < 1e-12
    expected = natural_orthogonal_complement(arm, q, qd).generalised_inertia
    for inertia in (composite_inertia, orthogonal_complement_inertia):
        np.testing.assert_allclose(inertia(links), expected, rtol=1e-10, atol=1e-11)
    solution = cholesky_solution(expected.tolist(), list(tau))
    np.testing.assert_allclose(solution, np.linalg.solve(expected, tau), rtol=1e-9)


def test_counting_leaves_out_what_is_known_beforehand():
    tally = Operations()
    x, y = Counted(2.0, tally), Counted(3.0, tally)
    assert (x * 0 == 0) and (0 * x == 0) and (x + 0 is x) and (0 + x is x)
    assert (x * 1).value == 2.0 and (-1 * x).value == -2.0
    assert tally == Operations(0, 0)
    assert (x * y + 1.0 - y / x).value == 5.5 and (1.0 - x).value == -1.0
    assert tally == Operations(2, 3)


def test_newton_euler_is_linear_and_near_the_book():
    counts = [operation_counts(ALGORITHMS[0], n) for n in range(2, 12)]
    n = np.arange(2, 12)
    assert [one.multiplications for one in counts] == (105 * n - 40).tolist()
    assert [one.additions for one in counts] == (87 * n - 50).tolist()


def polynomial(text, n):
    """Value of a polynomial of the table, such as ``n^3/6 + 13n^2 + 1061n/6 - 81``."""
    python = re.sub(r"(\d)n", r"\1*n", text.replace("^", "**"))
    return eval(python, {"n": n})


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_document_has_the_counts(algorithm):
    rows = [line for line in PAGE.read_text("utf-8").splitlines() if line.startswith("|")]
    (row,) = [line for line in rows if line.startswith(f"| {algorithm} |")]
    times, sums, at_six = (cell.strip() for cell in row.split("|")[2:5])
    for n in (2, 3, 6, 9):
        counted = operation_counts(algorithm, n)
        assert counted.multiplications == round(polynomial(times, n))
        assert counted.additions == round(polynomial(sums, n))
    counted = operation_counts(algorithm, 6)
    assert at_six == f"{counted.multiplications}, {counted.additions}"


def test_whole_numbers_of_numpy_count():
    assert operation_counts(ALGORITHMS[0], np.int64(2)) == operation_counts(ALGORITHMS[0], 2)


def test_wrong_requests_are_refused():
    with pytest.raises(BadValueError, match="one of inverse: newton-euler"):
        operation_counts("newton", 6)
    for n in (0, 51, 1.5, True, "6"):
        with pytest.raises(BadValueError, match="a whole number from 1 to 50"):
            operation_counts(ALGORITHMS[0], n)
