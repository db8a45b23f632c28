"""Kinetostatics of limbs of any kind, against those of robots with closed forms and the kernels."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinetostatics import jacobian
from robomech_ros.outcomes import Code
from robomech_ros.parallel import (
    Delta,
    Mechanism,
    Planar3RPR,
    Planar3RRR,
    dexterity,
    drive_accelerations,
    drive_forces,
    drive_rates,
    list_parallel,
    load_parallel,
    loop_singularity,
    platform_acceleration,
    platform_length,
    platform_twist,
    platform_wrench,
    singularity_distances,
    velocity_matrices,
    velocity_matrix_rates,
)

CORNERS = np.array([[0.0, 1.0], [-0.9, -0.5], [0.8, -0.6]])
CLOSED_FORMS = [n for n in list_parallel() if not isinstance(load_parallel(n), Mechanism)]
ANY_KIND = [n for n in list_parallel() if isinstance(load_parallel(n), Mechanism)]


def postures(mechanism, count, seed=3):
    """Postures with closed loops, for drives moved at random from home."""
    rng, home = np.random.default_rng(seed), mechanism.home()
    driven = mechanism.drive_index
    found = []
    while len(found) < count:
        step = 0.05 * rng.uniform(-1.0, 1.0, mechanism.dof) / mechanism.loops.weights[driven]
        closed = mechanism.close(home[driven] + step, home)
        if closed.status == 0:
            found.append(closed.q)
    return np.array(found)


def same_space(one, other, length):
    """Rows, in mixed units, span the same."""
    units = np.repeat([1.0, 1.0 / length], 3)
    one, other = one * units, other * units
    assert one.shape == other.shape
    np.testing.assert_allclose(one.T @ one, other.T @ other, atol=1e-9)


def same_report(robot, T, drives, q, length=None):
    closed = loop_singularity(robot, T, drives, length=length)
    found = loop_singularity(robot.mechanism, T, q, length=length)
    assert found.type == closed.type and found.kinds == closed.kinds
    assert found.limbs == closed.limbs and found.summary == closed.summary
    assert found.always == closed.always
    assert found.length == closed.length
    np.testing.assert_allclose(found.distances, closed.distances, atol=1e-9)
    np.testing.assert_allclose(found.singular_values, closed.singular_values, atol=1e-9)
    assert found.dexterity == pytest.approx(closed.dexterity, abs=1e-9)
    for part in ("lost_directions", "free_directions"):
        same_space(getattr(found, part), getattr(closed, part), found.length)
    for part in ("idle_wrenches", "unresisted_wrenches"):
        turned = (np.roll(getattr(one, part), 3, axis=1) for one in (found, closed))
        same_space(*turned, found.length)
    assert len(found.self_motions) == len(closed.self_motions)
    assert np.abs(found.internal_forces) == pytest.approx(np.abs(closed.internal_forces), abs=1e-9)
    return found


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_robots_with_closed_forms_and_their_limbs_agree(name):
    robot = load_parallel(name)
    mechanism = robot.mechanism
    q = postures(mechanism, 5)
    T, drives = mechanism.pose(q), q[:, mechanism.drive_index]
    # Both find the same characteristic length, which takes longer than all the rest.
    length = same_report(robot, T[0], drives[0], q[0]).length
    for k in range(len(q)):
        assert same_report(robot, T[k], drives[k], q[k], length).type == 0
    for function in (singularity_distances, dexterity):
        np.testing.assert_allclose(function(mechanism, T, q), function(robot, T, drives), atol=1e-9)
    K, J, motions = velocity_matrices(mechanism, T, q)
    closed = velocity_matrices(robot, T, drives)
    signs = np.sign(np.diagonal(closed.J, axis1=1, axis2=2))
    np.testing.assert_allclose(K * signs[..., None], closed.K, atol=1e-9)
    np.testing.assert_allclose(J * signs[..., None], closed.J, atol=1e-9)
    assert motions == closed.motions and (np.diagonal(J, axis1=1, axis2=2) > 0.0).all()


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_their_maps_agree(name):
    robot = load_parallel(name)
    mechanism = robot.mechanism
    q, rng = postures(mechanism, 4), np.random.default_rng(5)
    T, drives = mechanism.pose(q), q[:, mechanism.drive_index]
    rates, accelerations, forces = rng.uniform(-1.0, 1.0, (3, 4, mechanism.dof))
    wrench = rng.uniform(-1.0, 1.0, (4, 6))

    def both(function, *given):
        found, closed = function(mechanism, T, *given, q), function(robot, T, *given, drives)
        assert found == pytest.approx(closed, abs=1e-9 * max(1.0, np.abs(closed).max()))
        return closed

    twist = both(platform_twist, rates)
    assert both(drive_rates, twist) == pytest.approx(rates)
    dt = both(platform_acceleration, rates, accelerations)
    assert both(drive_accelerations, twist, dt) == pytest.approx(accelerations)
    both(drive_forces, wrench)
    both(platform_wrench, forces)


def in_front_of_a_singularity(mechanism, part):
    """Joints at a part of the way of the drives to a posture of type 2, and rates that lead on."""
    home, rng = mechanism.home(), np.random.default_rng(5)
    drives = home[mechanism.drive_index]
    while True:
        way = rng.uniform(-1.5, 1.5, mechanism.dof)
        found = mechanism.close(drives + way, home)
        if found.status == Code.SINGULAR and 0.1 < found.part < 0.95:
            return mechanism.close(drives + part * found.part * way, home).q, way


def same_matrix_rates(robot, q, twist, tolerance=1e-9):
    mechanism = robot.mechanism
    T, drives = mechanism.pose(q), q[mechanism.drive_index]
    signs = np.sign(np.diag(velocity_matrices(robot, T, drives).J))[:, None]
    closed = velocity_matrix_rates(robot, T, twist, drives)
    found = velocity_matrix_rates(mechanism, T, twist, q)
    allowed = tolerance * max(np.abs(closed.K).max(), np.abs(closed.J).max())
    assert allowed > 0.0
    np.testing.assert_allclose(found.K * signs, closed.K, atol=allowed)
    np.testing.assert_allclose(found.J * signs, closed.J, atol=allowed)


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_their_matrix_rates_agree(name):
    robot = load_parallel(name)
    mechanism = robot.mechanism
    q = postures(mechanism, 1)[0]
    twist = mechanism.rates(q, np.linspace(-1.0, 0.7, mechanism.dof))[1]
    same_matrix_rates(robot, q, twist)


@pytest.mark.parametrize("name", ANY_KIND)
def test_matrix_rates_of_limbs_of_any_kind_fit_their_accelerations(name):
    mechanism = load_parallel(name)
    q = postures(mechanism, 1)[0]
    rates, still = np.linspace(-1.0, 0.7, mechanism.dof), np.zeros(mechanism.dof)
    speeds, twist = mechanism.rates(q, rates)
    T, dt = mechanism.pose(q), mechanism.accelerations(q, speeds, still)[1]
    dK, dJ, _ = velocity_matrix_rates(mechanism, T, twist, q)
    K = velocity_matrices(mechanism, T, q).K
    assert np.abs(dK).max() > 0.1
    np.testing.assert_allclose(K @ dt + dK @ twist, dJ @ rates, atol=1e-9)


@pytest.mark.parametrize("part", [0.9, 0.99, 0.999])
def test_matrix_rates_are_as_exact_in_front_of_a_singularity_as_elsewhere(part):
    robot = load_parallel("planar_3rrr")
    q, rates = in_front_of_a_singularity(robot.mechanism, part)
    same_matrix_rates(robot, q, robot.mechanism.rates(q, rates)[1])


def test_matrix_rates_where_a_limb_is_nearly_stretched():
    # By less than the differences reach: on their other side the limb bends the other way.
    robot, pose = Planar3RRR(2.0 * CORNERS, CORNERS, [0.8, 3.0, 3.0], [0.6, 3.0, 3.0]), np.eye(4)
    pose[1, 3] = 2.4 - 1e-7
    q = robot.mechanism.postures(pose, ignore_limits=True).q[0]
    # What the limb bears without its drive is as ill-conditioned as its reach.
    same_matrix_rates(robot, q, np.array([0.0, 0.0, 0.3, 0.2, -0.1, 0.0]), 1e-7)


@pytest.mark.parametrize("name", ANY_KIND)
def test_limbs_of_any_kind_move_as_their_loops_do(name):
    mechanism = load_parallel(name)
    q, rng = postures(mechanism, 4), np.random.default_rng(6)
    T = mechanism.pose(q)
    rates, accelerations, forces = rng.uniform(-1.0, 1.0, (3, 4, mechanism.dof))
    speeds, twist = mechanism.rates(q, rates)
    assert platform_twist(mechanism, T, rates, q) == pytest.approx(twist, abs=1e-9)
    assert drive_rates(mechanism, T, twist, q) == pytest.approx(rates, abs=1e-9)
    dt = mechanism.accelerations(q, speeds, accelerations)[1]
    found = platform_acceleration(mechanism, T, rates, accelerations, q)
    assert found == pytest.approx(dt, abs=1e-8)
    found = drive_accelerations(mechanism, T, twist, dt, q)
    assert found == pytest.approx(accelerations, abs=1e-8)
    wrench = platform_wrench(mechanism, T, forces, q)
    assert (wrench * twist).sum(axis=1) == pytest.approx((forces * rates).sum(axis=1))
    assert drive_forces(mechanism, T, wrench, q) == pytest.approx(forces, abs=1e-9)
    # The dexterity is that of the twists of the drives, in units of their levers.
    found = loop_singularity(mechanism, T[0], q[0])
    assert found.type == 0 and 0.0 < found.dexterity <= 1.0
    K, J, motions = velocity_matrices(mechanism, T[0], q[0])
    assert K @ mechanism.twist_matrix(q[0]) == pytest.approx(J, abs=1e-9)
    assert motions == (0, 1, 2, 3, 4, 5)


def test_six_rods_are_as_far_from_singular_as_the_lines_of_their_forces_say():
    """The expected values follow from Pluecker coordinates of the rods alone."""
    mechanism = load_parallel("linapod")
    q = postures(mechanism, 1)[0]
    T, length = mechanism.pose(q), 0.2
    # The feet slide vertically: the work on a drive is the rod's share of the vertical.
    K, J, _ = velocity_matrices(mechanism, T, q)
    n, moment = K[:, 3:], K[:, :3]
    assert np.linalg.norm(n, axis=1) == pytest.approx(1.0)
    assert (n * moment).sum(axis=1) == pytest.approx(0.0, abs=1e-12)
    assert np.diag(J) == pytest.approx(np.abs(n[:, 2]))
    found = singularity_distances(mechanism, T, q, length=length)
    values = np.linalg.svd(np.hstack((moment / length, n)), compute_uv=False)
    assert found == pytest.approx([np.abs(n[:, 2]).min(), values[-1]])


def test_a_stretched_limb_is_of_type_1():
    robot = Planar3RRR(2.0 * CORNERS, CORNERS, [0.8, 3.0, 3.0], [0.6, 3.0, 3.0])
    pose = np.eye(4)
    pose[1, 3] = 2.4
    drives = robot.inverse(pose).q[0]
    rows = robot.mechanism.postures(pose, ignore_limits=True).q
    q = next(q for q in rows if np.allclose(q[robot.mechanism.drive_index], drives, atol=1e-6))
    found = same_report(robot, pose, q[robot.mechanism.drive_index], q)
    assert found.type == 1 and found.limbs == ((1,), ())
    assert np.isnan(platform_wrench(robot.mechanism, pose, [1.0, 0.0, 0.0], q)[2:5]).all()


def test_stretched_arms_of_a_delta_are_of_type_1():
    robot = load_parallel("delta")
    pose, inward = np.eye(4), robot.base_radius - robot.platform_radius
    pose[2, 3] = -np.sqrt((robot.arm + robot.forearm) ** 2 - inward**2)
    q = robot.mechanism.postures(pose, ignore_limits=True).q[0]
    found = same_report(robot, pose, q[robot.mechanism.drive_index], q)
    assert found.type == 1 and len(found.lost_directions) == 3


def test_free_motions_are_of_type_2():
    robot, pose = Planar3RPR(2.0 * CORNERS, CORNERS), np.eye(4)
    q = robot.mechanism.postures(pose).q[0]
    assert same_report(robot, pose, robot.inverse(pose), q, 1.0).type == 2
    assert np.isnan(platform_twist(robot.mechanism, pose, [1.0, 0.0, 0.0], q)[2:5]).all()
    robot, pose = load_parallel("sgp_3_3"), np.eye(4)
    pose[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    pose[2, 3] = 0.8
    q = robot.mechanism.postures(pose, ignore_limits=True).q[0]
    assert same_report(robot, pose, robot.inverse(pose), q).type == 2


def test_motions_that_limbs_prevent_in_other_postures_are_free_where_they_depend_on_each_other():
    """Forearms in the plane of the platform hold neither its height nor, as limbs R U U, its turn.

    The parallelograms of a Delta do: their normals are vertical there, but the couples that limbs
    R U U bear are along the forearms.
    """
    robot, pose = Delta(1.3, 0.1, 0.3, 1.2), np.eye(4)
    pose[2, 3] = -0.3
    mechanism = robot.mechanism
    rows = mechanism.postures(pose, ignore_limits=True).q
    drives = rows[:, mechanism.drive_index]
    k = int(np.argmin(np.abs(drives - np.pi / 2).sum(axis=1)))
    found = loop_singularity(mechanism, pose, rows[k], length=1.0)
    assert found.type == 2 and found.limbs == ((), (1, 2, 3)) and found.distances[1] < 1e-9
    same_space(found.free_directions, np.eye(6)[[2, 5]], 1.0)
    assert singularity_distances(mechanism, pose, rows[k], length=1.0)[1] < 1e-9
    # The passive joints of every limb alone give both motions.
    for limb, own in zip(mechanism.limbs, np.split(rows[k], 3), strict=True):
        passive = jacobian(limb.chain, own)[:, 1:]
        rates = np.linalg.lstsq(passive, found.free_directions.T, rcond=None)[0]
        assert passive @ rates == pytest.approx(found.free_directions.T, abs=1e-7)


def test_both_types_at_once():
    links = 0.5 * np.linalg.norm(CORNERS, axis=1)
    robot, pose = Planar3RRR(2.0 * CORNERS, CORNERS, links, links), np.eye(4)
    q = robot.mechanism.postures(pose, ignore_limits=True).q[0]
    found = same_report(robot, pose, q[robot.mechanism.drive_index], q, 1.0)
    assert found.type == 3


@pytest.mark.slow
def test_lengths():
    for name in CLOSED_FORMS:
        robot = load_parallel(name)
        assert platform_length(robot.mechanism) == platform_length(robot)
    for name in ANY_KIND:
        mechanism = load_parallel(name)
        length = platform_length(mechanism)
        assert 0.01 * mechanism.size < length < mechanism.size
        assert loop_singularity(mechanism, mechanism.pose(mechanism.home()), mechanism.home())
    # Without the robot whose limbs they are, they are judged by postures: translations, or turns.
    for name in ("delta", "agile_eye"):
        mechanism = load_parallel(name).mechanism
        own = Mechanism(mechanism.limbs, home_poses=[mechanism.pose(mechanism.home())])
        assert platform_length(own) == 1.0


def test_what_is_refused():
    mechanism = load_parallel("tripod_3prs")
    q = mechanism.home()
    T = mechanism.pose(q)
    with pytest.raises(BadValueError, match="positions of all joints"):
        loop_singularity(mechanism, T)
    with pytest.raises(RobomechError, match="q has shape"):
        loop_singularity(mechanism, T, q[mechanism.drive_index])
    away = T.copy()
    away[0, 3] += 0.01
    with pytest.raises(BadValueError, match="limb 2 misses the pose"):
        loop_singularity(mechanism, away, q)
    opened = q.copy()
    opened[-1] += 0.1
    with pytest.raises(BadValueError, match="limb 3 misses the pose"):
        singularity_distances(mechanism, T, opened)
    with pytest.raises(BadValueError, match="limbs prevent"):
        drive_rates(mechanism, T, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0], q)
    with pytest.raises(BadValueError, match="limbs prevent"):
        drive_accelerations(mechanism, T, np.zeros(6), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0], q)
    for wrong in ([1], None, {}, "hexapod"):
        with pytest.raises(BadValueError, match="robot"):
            platform_length(wrong)
