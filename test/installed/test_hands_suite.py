"""A hand that is brought up, and asked across processes."""

PAIR = {
    "positions": [{"x": 0.04}, {"x": -0.04}],
    "normals": [{"x": -1.0}, {"x": 1.0}],
    "friction": [0.5],
    "wrench": {"force": {"z": -2.0}},
}


def test_a_hand_is_brought_up_and_asked(suite, bringup):
    with bringup("--robot", "three_fingered"):
        soft = {**PAIR, "models": ["soft"], "torsional": [0.01]}
        held = suite.call("grasping/contact_forces", soft)
        assert held["error_code"] == 0, held["error_msg"]
        assert abs(held["total"] - 4.0) < 1e-6
        twisted = {**PAIR, "wrench": {"torque": {"x": 0.1}}}
        refused = suite.call("grasping/contact_forces", twisted)
        assert refused["error_code"] == 209
        assert refused["separating_wrench"]["wrench"]["torque"]["x"] < 0.0
        contacts = {name: soft[name] for name in soft if name != "wrench"}
        assert suite.call("grasping/analyze_grasp", contacts)["force_closed"] is True
        rim = [{"x": 0.04}, {"x": -0.02, "y": 0.0346}, {"x": -0.02, "y": -0.0346}]
        pose = {"position": {"z": 0.08}, "orientation": {"w": 1.0}}
        found = suite.call(
            "grasping/solve_grasp", {"object_pose": {"pose": pose}, "positions": rim}
        )
        assert (found["error_code"], found["complete"]) == (0, True)
        assert len(found["solutions"]) == found["counts"][0] ** 3
