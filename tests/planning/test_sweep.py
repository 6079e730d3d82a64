import numpy as np
import pinocchio as pin
import pytest

from mmplan.planning.sweep import sweep_of


def box_corners(body):
    """Corners (8, 3) of a body's own bounding box, in its joint's frame."""
    body.geometry.computeLocalAABB()
    box = body.geometry.aabb_local
    low, high = np.ravel(box.min_), np.ravel(box.max_)
    choose = (np.arange(8)[:, None] >> np.arange(3)) & 1
    return [body.placement.act(c) for c in np.where(choose, high, low)]


def body_points(world, q):
    """Corners of every moving body's box in the world, (points, 3)."""
    data = world.model.createData()
    pin.forwardKinematics(world.model, data, q)
    return np.array(
        [
            data.oMi[body.parentJoint].act(point)
            for body in world.geometry.geometryObjects
            if body.parentJoint
            for point in box_corners(body)
        ]
    )


@pytest.fixture(params=[False, True], ids=["empty hand", "carrying"])
def world(request, kitchen_world):
    if not request.param:
        return kitchen_world
    T_tool_object = pin.SE3(pin.utils.rpyToMatrix(0.3, 1.2, 0.0), np.array([0, 0, 0.1]))
    return kitchen_world.attach("wineglass", T_tool_object.homogeneous)


@pytest.mark.parametrize("size", [0.001, 0.1, 1.0])
def test_no_point_moves_farther_than_the_bound(world, size):
    rng = np.random.default_rng(0)
    sweep = sweep_of(world)
    lower, upper = world.model.lowerPositionLimit, world.model.upperPositionLimit
    for _ in range(50):
        q, other = rng.uniform(lower, upper, (2, world.model.nq))
        dq = size * (other - q)
        moved = body_points(world, q + dq) - body_points(world, q)
        assert np.linalg.norm(moved, axis=1).max() <= sweep.distance(dq) + 1e-12


def test_a_carried_object_lengthens_the_lever_arms(kitchen_world):
    T_tool_object = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.5])).homogeneous
    carrying = kitchen_world.attach("wineglass", T_tool_object)
    more = sweep_of(carrying).weights - sweep_of(kitchen_world).weights
    arm = kitchen_world.robot.arm.indices
    assert np.all(more >= 0.0)
    assert np.all(more[arm[:5]] > 0.3)


def test_the_stick_has_the_lever_arms_seen_by_eye(stick_among):
    assert sweep_of(stick_among()).weights == pytest.approx([1.0, 1.0, 0.5])


def test_a_joint_with_two_coordinates_is_refused():
    class World:
        model = pin.buildSampleModelHumanoid()
        geometry = pin.GeometryModel()

    with pytest.raises(ValueError, match="one degree of freedom"):
        sweep_of(World())
