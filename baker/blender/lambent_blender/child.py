"""Finds Lambent's programs and runs them beside Blender. It knows nothing of Blender."""
import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

# A bake writes "37 %  direct light, 1.2 M samples/s, about 12.0 s left" (baker/cli/output.cpp).
PROGRESS = re.compile(r"(?:lambent: )?\s*(\d+) %  (.+)")


class Problem(Exception):
    """It says in one line what is wrong and what to do."""


def find_program(name: str, chosen: str) -> Path:
    """Returns `name` beside the chosen program `lambent`, or if none was chosen, on PATH or where we were built."""
    if chosen:
        path = Path(chosen).expanduser()
        path = path / name if path.is_dir() else path if name == "lambent" else path.with_name(name)
        if path.is_file() and os.access(path, os.X_OK):
            return path
        raise Problem(f"{path} is not a program; correct the path in Preferences > Add-ons > Lambent")
    places = [folder / bin_folder for folder in Path(__file__).resolve().parents
              for bin_folder in ("bin", "build/release/bin")]
    found = shutil.which(name) or shutil.which(name, path=os.pathsep.join(map(str, places)))
    if not found:
        raise Problem(f"{name} was not found on PATH; give the path of lambent in Preferences > Add-ons > Lambent")
    return Path(found)


class Child:
    """A program that runs. Whoever started it calls poll() again and again.

    Its stderr is a terminal of its own: there `lambent` says ten times a second how far it is, and only every ten
    seconds in a file. Its report goes to Blender's stdout.
    """

    def __init__(self, command: list[str]) -> None:
        self.share = 0.0
        self.stage = ""
        self.lines: list[str] = []
        self.rest = b""
        self.terminal, stderr = os.openpty()
        os.set_blocking(self.terminal, False)
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=stderr)
        except OSError as error:
            os.close(self.terminal)
            raise Problem(f"{command[0]} does not start: {error.strerror}; "
                          "correct the path in Preferences > Add-ons > Lambent") from None
        finally:
            os.close(stderr)

    def poll(self) -> int | None:
        """Reads what it has said, and returns its exit code, or None while it runs."""
        code = self.process.poll()  # before reading, so that no last word is lost
        try:
            while self.terminal >= 0 and (said := os.read(self.terminal, 65536)):
                self.hear(said)
        except BlockingIOError:
            pass
        except OSError:  # Linux ends a terminal with an error.
            self.close()
        if code is not None:
            self.hear(b"\n")
            self.close()
        return code

    def hear(self, said: bytes) -> None:
        *lines, self.rest = re.split(rb"[\r\n]+", self.rest + said)
        for line in map(self.plain, lines):
            if found := PROGRESS.fullmatch(line):
                self.share, self.stage = int(found[1]) / 100, found[2]
            elif line:
                self.lines.append(line)

    @staticmethod
    def plain(line: bytes) -> str:
        return line.replace(b"\x1b[K", b"").decode(errors="replace").rstrip()

    def interrupt(self) -> None:
        """Asks it to stop after the work in hand; a second time ends it at once."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)

    def error(self) -> str:
        """Returns its last word, which is its error if it has failed."""
        return self.lines[-1] if self.lines else f"{self.process.args[0]} ended with code {self.process.returncode}"

    def close(self) -> None:
        if self.terminal >= 0:
            os.close(self.terminal)
            self.terminal = -1
