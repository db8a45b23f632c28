"""Maps computed by a Dask cluster: the same as by the threads of one process."""

import socket

import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import load_reach_map, reach_map
from robomech_ros.robots import load_robot

distributed = pytest.importorskip("distributed", reason="Dask is an extra")

PUMA = load_robot("puma560")
BOX = {"lower": [-1] * 3, "upper": [1] * 3, "shape": 9, "orientations": 150, "length": 0.3}


@pytest.fixture(scope="module")
def cluster():
    # Workers in this process have its kernels already; messages go through sockets all the same.
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=False,
        protocol="tcp://",
        dashboard_address=":0",
    ) as found:
        yield found


@pytest.mark.slow
def test_a_map_by_dask_is_that_of_threads_byte_for_byte(cluster, tmp_path):
    file, steps = tmp_path / "map.npz", []

    def interrupt(done, total):
        steps.append(done)
        if 0 < done < total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reach_map(PUMA, **BOX, scheduler=cluster.scheduler_address, file=file, progress=interrupt)
    assert load_reach_map(file).finished == steps[-1] > 0
    found = reach_map(PUMA, **BOX, scheduler=cluster.scheduler_address, file=file)
    alone = reach_map(PUMA, **BOX)
    assert found.complete
    assert found.cells.tobytes() == alone.cells.tobytes()
    assert file.read_bytes() == alone.save(tmp_path / "alone.npz").read_bytes()


def test_a_scheduler_that_is_none_is_refused(monkeypatch, tmp_path):
    monkeypatch.setattr("robomech_ros.kinetostatics.maps.engines._PATIENCE", 0.5)
    with socket.socket() as deaf:
        deaf.bind(("127.0.0.1", 0))
        deaf.listen()
        silent = f"tcp://127.0.0.1:{deaf.getsockname()[1]}"
        for address in (silent, "tcp://127.0.0.1:1", "nonsense", "", 3, "foo://x:1"):
            with pytest.raises(BadValueError, match="running Dask scheduler with workers"):
                reach_map(PUMA, **BOX, scheduler=address, file=tmp_path / "map.npz")
    assert not (tmp_path / "map.npz").exists()


def test_a_scheduler_without_workers_is_refused():
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as empty,
        pytest.raises(BadValueError, match="it has no workers"),
    ):
        reach_map(PUMA, **BOX, scheduler=empty.scheduler_address)


def test_a_worker_with_another_version_is_refused(cluster, monkeypatch):
    monkeypatch.setattr("robomech_ros.kinetostatics.maps.engines.__version__", "0.0.0")
    with pytest.raises(BadValueError, match="version of robomech_ros on the worker is '0.0.0'"):
        reach_map(PUMA, **BOX, scheduler=cluster.scheduler_address)
