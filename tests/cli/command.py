"""What tests of the venation command share: running it, comparing what it left, TAP. Needs the standard library alone."""
import fcntl
import os
import pty
import shutil
import struct
import subprocess
import sys
import tempfile
import termios

if len(sys.argv) < 2:
    sys.exit(sys.modules["__main__"].__doc__)
VENATION = os.path.abspath(sys.argv[1])
TIMEOUT = 120


class Skip(Exception):
    pass


class Missing(Skip):
    """A program that `./run test` installs: no excuse where VENATION_REQUIRE is all."""


class Result:
    def __init__(self, status, out, err):
        self.status, self.out, self.err = status, out, err


def environment(**changes):
    env = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "COLUMNS", "G_MESSAGES_DEBUG")}
    env.update(TERM="xterm", LC_ALL="C.UTF-8")
    env.update(changes)
    return env


def run(*args, env=None, before=None, stdout=subprocess.PIPE):
    done = subprocess.run([VENATION, *args], stdin=subprocess.DEVNULL, stdout=stdout, stderr=subprocess.PIPE,
                          env=env or environment(), preexec_fn=before, timeout=TIMEOUT)
    return Result(done.returncode, (done.stdout or b"").decode(), done.stderr.decode())


def run_on_terminal(*args, env=None, columns=80):
    """stderr on a terminal; the result's err is what it showed."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = subprocess.Popen([VENATION, *args], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=slave,
                               env=env or environment())
    os.close(slave)
    shown = b""
    while True:
        try:
            part = os.read(master, 65536)
        except OSError:  # EIO: the other end is closed
            break
        if not part:
            break
        shown += part
    out = process.stdout.read().decode()
    os.close(master)
    return Result(process.wait(TIMEOUT), out, shown.decode())


def write(name, text):
    with open(name, "w" if isinstance(text, str) else "wb") as file:
        file.write(text)
    return name


def files(folder):
    return sorted(os.path.relpath(os.path.join(d, f), folder) for d, _, names in os.walk(folder) for f in names)


def contents(folder):
    found = {}
    for name in files(folder):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = file.read()
    return found


def same(found, wanted, what="value"):
    if found != wanted:
        raise AssertionError(f"{what}: found {found!r}, wanted {wanted!r}")


def holds(text, part):
    if part not in text:
        raise AssertionError(f"no {part!r} in {text!r}")


def lacks(text, part):
    if part in text:
        raise AssertionError(f"{part!r} in {text!r}")


def need(*programs):
    absent = [program for program in programs if not shutil.which(program)]
    if absent:
        raise Missing("no " + ", ".join(absent))


def check_refused(result, status, *parts):
    """One message on stderr, nothing on stdout, nothing written."""
    same(result.status, status, f"exit status (stderr {result.err!r})")
    same(result.out, "", "stdout")
    lines = result.err.splitlines()
    if not lines or not lines[0].startswith("venation: ") or len(lines) > 2:
        raise AssertionError(f"not one message: {result.err!r}")
    for part in parts:
        holds(result.err, part)
    if os.path.exists("out"):
        raise AssertionError(f"left behind: {os.listdir('out')}")


def main(tests):
    """Runs each function of the dictionary that is called test_… in a folder of its own."""
    tests = [(name[5:], test) for name, test in tests.items() if name.startswith("test_")]
    failed = 0
    print(f"1..{len(tests)}", flush=True)
    for number, (name, test) in enumerate(tests, 1):
        with tempfile.TemporaryDirectory(prefix="venation-") as folder:
            os.chdir(folder)
            try:
                test()
                line = f"ok {number} - {name}"
            except Exception as problem:  # one that fails must not stop the rest
                if isinstance(problem, Skip) and not (isinstance(problem, Missing) and os.environ.get("VENATION_REQUIRE") == "all"):
                    line = f"ok {number} - {name} # SKIP {problem}"
                else:
                    failed += 1
                    line = f"not ok {number} - {name}\n# {type(problem).__name__}: " + str(problem).replace("\n", "\n# ")
            os.chdir("/")
        print(line, flush=True)
    return 1 if failed else 0

