"""Finds Lambent's programs and runs them beside Blender. It knows nothing of Blender."""
import json
import os
import shutil
import signal
import subprocess
from pathlib import Path


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

    With --progress json `lambent` says each second how far it is, as an object a line among the lines of its stderr
    (docs/baking.md). Its report goes to Blender's stdout.
    """

    def __init__(self, command: list[str]) -> None:
        self.share = 0.0
        self.stage = ""
        self.lines: list[str] = []
        self.rest = b""
        self.pipe, stderr = os.pipe()
        os.set_blocking(self.pipe, False)
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=stderr)
        except OSError as error:
            os.close(self.pipe)
            raise Problem(f"{command[0]} does not start: {error.strerror}; "
                          "correct the path in Preferences > Add-ons > Lambent") from None
        finally:
            os.close(stderr)

    def poll(self) -> int | None:
        """Reads what it has said, and returns its exit code, or None while it runs."""
        code = self.process.poll()  # before reading, so that no last word is lost
        try:
            while self.pipe >= 0 and (said := os.read(self.pipe, 65536)):
                self.hear(said)
        except BlockingIOError:
            pass
        if code is not None:
            self.hear(b"\n")
            self.close()
        return code

    def hear(self, said: bytes) -> None:
        *lines, self.rest = (self.rest + said).split(b"\n")
        for line in (line.decode(errors="replace").rstrip() for line in lines):
            if line.startswith("{"):
                progress = json.loads(line)
                self.share, self.stage = progress["share"], self.words_of(progress)
            elif line:
                self.lines.append(line)

    @staticmethod
    def words_of(progress: dict) -> str:
        """Returns for example "direct light, about 1:02 min left"."""
        seconds = round(progress["secondsLeft"])
        left = f"{seconds} s" if seconds < 60 else f"{seconds // 60}:{seconds % 60:02} min"
        return progress["stage"] + (f", about {left} left" if seconds > 0 else "")

    def interrupt(self) -> None:
        """Asks it to stop after the work in hand; a second time ends it at once."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)

    def error(self) -> str:
        """Returns its last word, which is its error if it has failed."""
        return self.lines[-1] if self.lines else f"{self.process.args[0]} ended with code {self.process.returncode}"

    def close(self) -> None:
        if self.pipe >= 0:
            os.close(self.pipe)
            self.pipe = -1
