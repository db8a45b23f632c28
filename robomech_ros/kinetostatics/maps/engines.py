"""Computation of map cells: in threads of this process, or by Dask on many machines.

An engine gives the chunks in the order in which they are done; their content does not depend on
where they were computed.
"""

import asyncio
import os
import threading
from collections.abc import Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from robomech_ros import __version__
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinetostatics.maps.cells import map_cells
from robomech_ros.kinetostatics.maps.request import MapRequest
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.entry_checks import whole_number

if TYPE_CHECKING:
    from distributed import Client

# Cells from the first to before the last.
Chunk = tuple[int, int]
Done = tuple[Chunk, NDArray]

# Chunks that wait at a worker while it is at work on another.
_WAITING = 3
# Times that Dask tries a chunk anew whose worker is lost, and seconds for it to answer at first.
_RETRIES = 3
_PATIENCE = 10.0


class DaskUnavailableError(RobomechError):
    """Dask is not installed."""

    def __init__(self) -> None:
        super().__init__(
            "a scheduler was given, and to work with it needs Dask: "
            "pip install 'robomech_ros[dask]'"
        )


def as_workers(workers: int | None) -> int:
    """Check a number of threads; None is one for each processor that this process may use."""
    if workers is None:
        return len(os.sched_getaffinity(0))
    return whole_number("workers", workers, 1, 1024, "a whole number from 1 to 1024")


def in_threads(
    chain: SerialChain, request: MapRequest, chunks: Iterator[Chunk], workers: int
) -> Generator[Done, None, None]:
    """Compute chunks in threads; the kernels, which take all the time, hold no lock.

    To close the generator stops them within some milliseconds.
    """
    stop = threading.Event()
    with ThreadPoolExecutor(workers) as pool:
        running: dict[Future[NDArray | None], Chunk] = {}
        try:
            while True:
                for chunk in islice(chunks, workers * (1 + _WAITING) - len(running)):
                    future = pool.submit(map_cells, chain, request, *chunk, stop.is_set)
                    running[future] = chunk
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    cells = future.result()
                    if cells is not None:
                        yield running[future], cells
                    del running[future]
        finally:
            stop.set()
            for future in running:
                future.cancel()


def by_dask(
    chain: SerialChain, request: MapRequest, chunks: Iterator[Chunk], address: str
) -> Generator[Done, None, None]:
    """Compute chunks as tasks of a Dask cluster whose workers have the same robomech_ros.

    The address is that of the scheduler, such as ``tcp://10.0.0.1:8786``.
    """
    try:
        from distributed import as_completed
    except ImportError:
        raise DaskUnavailableError from None
    with _connected(address) as client:
        (given,) = client.scatter([(chain, request)], broadcast=True, hash=False)
        running: dict[Any, Chunk] = {}

        def submit(count: int) -> list[Any]:
            new = []
            for chunk in islice(chunks, count):
                # Not pure: another map may have a chunk of the same numbers.
                future = client.submit(_task, given, *chunk, pure=False, retries=_RETRIES)
                running[future] = chunk
                new.append(future)
            return new

        threads = sum(client.nthreads().values())
        done = as_completed(submit(threads * (1 + _WAITING)), loop=client.loop)
        for future in done:
            cells = future.result()
            chunk = running.pop(future)
            for new in submit(1):
                done.add(new)
            yield chunk, cells


def _connected(address: str) -> "Client":
    """Connect to a scheduler, once it has said that it is one: Dask waits for others for ever."""
    from distributed import Client

    expected = "the address of a running Dask scheduler with workers, such as tcp://10.0.0.1:8786"
    if not isinstance(address, str) or not address:
        raise BadValueError("scheduler", address, expected)
    try:
        with ThreadPoolExecutor(1) as pool:  # where a loop may be running already there is another
            identity = pool.submit(asyncio.run, _identity(address)).result()
    except (OSError, ValueError, asyncio.TimeoutError) as error:
        first = (str(error) or type(error).__name__).splitlines()[0]
        raise BadValueError("scheduler", address, f"{expected} ({first})") from None
    if identity.get("type") != "Scheduler":
        raise BadValueError("scheduler", address, f"{expected} (a {identity.get('type')} answers)")
    if not identity["workers"]:
        raise BadValueError("scheduler", address, f"{expected} (it has no workers)")
    return Client(address, timeout=_PATIENCE, set_as_default=False)


async def _identity(address: str) -> dict[str, Any]:
    """Ask what listens at an address."""
    from distributed.core import rpc

    async def ask() -> dict[str, Any]:
        async with rpc(address, timeout=_PATIENCE) as peer:
            return dict(await peer.identity())

    return await asyncio.wait_for(ask(), _PATIENCE)


def _task(given: tuple[SerialChain, MapRequest], first: int, last: int) -> NDArray | None:
    chain, request = given
    if request.version != __version__:
        expected = f"{request.version}, as on the machine that requests the map"
        raise BadValueError("version of robomech_ros on the worker", __version__, expected)
    return map_cells(chain, request, first, last)
