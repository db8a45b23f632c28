"""How nodes spin and stop."""

import threading

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_ros.nodes.process import run
from robomech_ros.nodes.process.run import Spinner, run_nodes


class Nervous(Node):
    """Fails at the first call, and takes its time to stop."""

    def __init__(self, **options):
        super().__init__("nervous", **options)
        self.calls = 0
        self.stopped_in = ""
        self.create_service(Trigger, "~/poke", self._poke)
        self.create_timer(0.001, self._fail)

    def _poke(self, request, response):
        self.calls += 1
        response.success = True
        return response

    def _fail(self):
        raise RuntimeError("nerves")

    async def stop(self):
        self.stopped_in = threading.current_thread().name


def test_a_failing_callback_does_not_end_the_node(graph, capfd):
    node = graph.start(Nervous)
    for _ in range(3):
        assert graph.ask(Trigger, "nervous/poke").success
    assert node.calls == 3
    assert "nerves" in capfd.readouterr().err


def test_stop_runs_in_the_spinning_thread(graph):
    node = Nervous(context=graph.context)
    spinner = Spinner([node], graph.context)
    ended = threading.Event()
    spinner.start(on_end=ended.set)
    spinner.stop()
    assert ended.wait(10.0)
    assert node.stopped_in == "spin"
    node.destroy_node()


def test_stop_that_fails_is_logged_and_the_next_node_stops_all_the_same(graph, capfd):
    class Stubborn(Node):
        def stop(self):
            raise RuntimeError("never")

    stubborn, node = Stubborn("stubborn", context=graph.context), Nervous(context=graph.context)
    spinner = Spinner([stubborn, node], graph.context)
    spinner.start()
    spinner.stop()
    assert node.stopped_in == "spin"
    assert "never" in capfd.readouterr().err
    for each in (stubborn, node):
        each.destroy_node()


def test_stop_that_hangs_is_not_waited_for_forever(graph, monkeypatch):
    monkeypatch.setattr(run, "_STOP_SECONDS", 0.2)
    release = threading.Event()

    class Stuck(Node):
        def stop(self):
            release.wait(30.0)

    node = Stuck("stuck", context=graph.context)
    spinner = Spinner([node], graph.context)
    spinner.start()
    spinner.stop()
    release.set()
    node.destroy_node()


def test_a_context_that_ends_under_a_callback_is_no_defect(domain_id, capfd):
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain_id)
    node, ended = Node("late", context=context), threading.Event()

    def shut_down():
        context.try_shutdown()
        node.create_timer(1.0, shut_down)

    node.create_timer(0.01, shut_down)
    spinner = Spinner([node], context)
    spinner.start(ended.set)
    assert ended.wait(30.0)
    spinner.stop()
    node.destroy_node()
    assert "please report" not in capfd.readouterr().err


def test_a_spinner_that_never_started_can_be_stopped(graph):
    Spinner([graph.client], graph.context).stop()


def test_unknown_arguments_are_refused(capsys):
    assert run_nodes([Nervous], ["some_node", "--fast"]) == 2
    assert capsys.readouterr().err == "some_node: unknown argument '--fast'; see --help\n"


def test_broken_ros_arguments_are_refused(capsys):
    assert run_nodes([Nervous], ["some_node", "--ros-args", "-p", "rate"]) == 2
    assert capsys.readouterr().err.startswith("some_node: Failed to parse ROS arguments")
