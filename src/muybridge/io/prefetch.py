"""Reading ahead in a thread: the next pictures are decoded while the present ones are worked on."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterable, Iterator
from typing import TypeVar

Item = TypeVar("Item")


def prefetched(items: Iterable[Item], depth: int) -> Iterator[Item]:
    """Yield the same items in the same order, up to `depth` of them made ahead by one thread.

    What goes wrong there is raised here, at its place in the order. With `depth` 0 no thread is started.
    """
    if depth <= 0:
        yield from items
        return
    waiting: queue.Queue[tuple[str, object]] = queue.Queue(maxsize=depth)
    stop = threading.Event()
    worker = threading.Thread(target=_fill, args=(items, waiting, stop), name="prefetch", daemon=True)
    worker.start()
    try:
        while True:
            kind, item = waiting.get()
            if kind == "end":
                return
            if kind == "error":
                raise item  # type: ignore[misc]
            yield item  # type: ignore[misc]
    finally:
        stop.set()
        _empty(waiting)
        worker.join()


def _fill(items: Iterable[object], waiting: queue.Queue, stop: threading.Event) -> None:
    """Put everything into the queue; end early where nobody wants more."""
    iterator = iter(items)
    try:
        for item in iterator:
            _put(("item", item), waiting, stop)
            if stop.is_set():
                break
        _put(("end", None), waiting, stop)
    except BaseException as error:  # noqa: BLE001 - handed to the reader, who raises it
        _put(("error", error), waiting, stop)
    finally:
        # A generator must be closed by the thread that ran it: it may hold a decoder.
        close = getattr(iterator, "close", None)
        if close is not None:
            close()


def _put(entry: tuple[str, object], waiting: queue.Queue, stop: threading.Event) -> None:
    while not stop.is_set():
        try:
            return waiting.put(entry, timeout=0.1)
        except queue.Full:
            pass


def _empty(waiting: queue.Queue) -> None:
    try:
        while True:
            waiting.get_nowait()
    except queue.Empty:
        pass
