"""Computers with networks of their own, on this machine: network namespaces at one bridge.

Links are cut and made lossy by iptables, as no kernel here has netem.
"""

import ctypes
import http.client
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, Self, TypeAlias, TypeVar

_LIBC = ctypes.CDLL(None, use_errno=True)
_CLONE_NEWNET = 0x40000000
"""Of <sched.h>; Python knows it from 3.12 on."""
_BRIDGE = "hub"
_NET = "10.77.0"
_PATIENCE_S = 20.0

Json: TypeAlias = Any
Result = TypeVar("Result")


def why_not() -> str | None:
    """Return why there can be no namespaces here; None: there can."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return "network namespaces need Linux and root"
    for tool in ("ip", "iptables"):
        if shutil.which(tool) is None:
            return f"there is no {tool}"
    name = f"ph{os.getpid()}try"
    if subprocess.run(["ip", "netns", "add", name], check=False, capture_output=True).returncode:
        return "network namespaces cannot be made here"
    drop = ["iptables", "-A", "INPUT", "-m", "statistic", "--mode", "random"]
    drop += ["--probability", "0.5", "-j", "DROP"]
    tried = subprocess.run(
        ["ip", "netns", "exec", name, *drop], check=False, capture_output=True
    ).returncode
    subprocess.run(["ip", "netns", "del", name], check=True)
    return "this kernel cannot lose packets by iptables" if tried else None


class Host:
    """One computer: a namespace with an address, and a thread that lives in it."""

    def __init__(self, namespace: str, address: str) -> None:
        self.namespace = namespace
        self.address = address
        self._thread = ThreadPoolExecutor(1, initializer=self._enter)

    def command(self, *command: str) -> tuple[str, ...]:
        """Return a command line that runs a command on this computer."""
        return ("ip", "netns", "exec", self.namespace, *command)

    def do(self, work: Callable[[], Result]) -> Result:
        """Do something on this computer, and return its result; its sockets are there."""
        return self._thread.submit(work).result(_PATIENCE_S)

    def ask(self, method: str, path: str, body: object = None, port: int = 8000) -> Json:
        """Ask the service of this computer, over its loopback; return the JSON of the answer."""

        def work() -> Json:
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=_PATIENCE_S / 2)
            try:
                connection.request(method, path, None if body is None else json.dumps(body))
                return json.loads(connection.getresponse().read() or b"null")
            finally:
                connection.close()

        return self.do(work)

    def _enter(self) -> None:
        file = os.open(f"/run/netns/{self.namespace}", os.O_RDONLY)
        try:
            if _LIBC.setns(file, _CLONE_NEWNET):
                raise OSError(ctypes.get_errno(), "setns")
        finally:
            os.close(file)

    def run(self, *command: str) -> None:
        """Run a command on this computer to its end."""
        subprocess.run(self.command(*command), check=True, capture_output=True)

    def close(self) -> None:
        """End the thread."""
        self._thread.shutdown()


class Network:
    """Computers at one bridge, and what is wrong between them."""

    def __init__(self, names: Sequence[str]) -> None:
        """Make the namespaces; `close` removes them.

        Args:
            names: Of the computers; short.
        """
        self._prefix = f"ph{os.getpid()}"
        self._hub = f"{self._prefix}{_BRIDGE}"
        _ip("netns", "add", self._hub)
        _ip("-n", self._hub, "link", "add", _BRIDGE, "type", "bridge")
        _ip("-n", self._hub, "link", "set", _BRIDGE, "up")
        self.hosts = {name: self._host(name, number) for number, name in enumerate(names, start=1)}

    def _host(self, name: str, number: int) -> Host:
        namespace = f"{self._prefix}{name}"
        address = f"{_NET}.{number}"
        _ip("netns", "add", namespace)
        _ip(*f"-n {self._hub} link add to{number} type veth peer name eth0".split())
        _ip("-n", self._hub, "link", "set", "eth0", "netns", namespace)
        _ip(*f"-n {self._hub} link set to{number} master {_BRIDGE} up".split())
        _ip(*f"-n {namespace} addr add {address}/24 dev eth0".split())
        _ip("-n", namespace, "link", "set", "eth0", "up")
        _ip("-n", namespace, "link", "set", "lo", "up")
        return Host(namespace, address)

    def cut(self, one: str, other: str) -> None:
        """Let nothing pass between two computers any more."""
        self.cut_towards(one, other)
        self.cut_towards(other, one)

    def cut_towards(self, sender: str, receiver: str) -> None:
        """Let nothing pass from one computer to another one any more."""
        self._drop(sender, receiver)

    def lose(self, sender: str, receiver: str, share: float) -> None:
        """Lose a share of the packets from one computer to another one, by chance."""
        by_chance = ("-m", "statistic", "--mode", "random", "--probability", str(share))
        self._drop(sender, receiver, *by_chance)

    def _drop(self, sender: str, receiver: str, *which: str) -> None:
        source = self.hosts[sender].address
        self.hosts[receiver].run("iptables", "-A", "INPUT", "-s", source, *which, "-j", "DROP")

    def heal(self) -> None:
        """Let everything pass again."""
        for host in self.hosts.values():
            host.run("iptables", "-F", "INPUT")

    def __enter__(self) -> Self:
        """Return the network."""
        return self

    def __exit__(self, *_: object) -> None:
        """Remove the namespaces."""
        for host in self.hosts.values():
            host.close()
            _ip("netns", "del", host.namespace)
        _ip("netns", "del", self._hub)


@contextmanager
def started(host: Host, *command: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a command on a computer as long as the context lasts; then it is killed."""
    process = subprocess.Popen(
        host.command(*command), stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def _ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True, capture_output=True)
