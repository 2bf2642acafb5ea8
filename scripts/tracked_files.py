"""The files of the repository, for the checks that read all of them."""
import subprocess


def tracked_files(root):
    """Files that git tracks or would add; without git, all files but those in build/ and out/."""
    listing = subprocess.run(
        ["git", "-c", "safe.directory=*", "-C", root, "ls-files", "-z", "--cached", "--others",
         "--exclude-standard"], capture_output=True, check=False)
    if listing.returncode == 0:
        paths = [root / name for name in sorted(set(filter(None, listing.stdout.decode().split("\0"))))]
    else:
        skipped = {root / "build", root / "out", root / ".git"}
        paths = [path for path in sorted(root.rglob("*")) if not skipped.intersection(path.parents)]
    return [path for path in paths if path.is_file() and not path.is_symlink()]


def read_text(path):
    """The content of a text file; None for a binary file."""
    content = path.read_bytes()
    return None if b"\0" in content[:8192] else content.decode("utf-8", "replace")
