"""Packs the add-on and wheels of the package sscc into an extension of Blender: one zip file.

    python build_extension.py --out FOLDER WHEEL [WHEEL ...]

One wheel for each platform. The manifest in the zip file names the wheels and their platforms. The same files give the
same bytes.
"""

from __future__ import annotations

import argparse
import re
import sys
import tomllib
import zipfile
from pathlib import Path

FOLDER = Path(__file__).parent
ADDON = FOLDER / "sscc_shape_keys"
LICENCES = [FOLDER.parent / "LICENSE-MIT", FOLDER.parent / "LICENSE-APACHE"]

# Blender's names of platforms, by the end of a wheel's platform tag.
PLATFORMS = {
    r"manylinux.*_x86_64|linux_x86_64": "linux-x64",
    r"macosx_.*_x86_64": "macos-x64",
    r"macosx_.*_arm64": "macos-arm64",
    r"win_amd64": "windows-x64",
    r"win_arm64": "windows-arm64",
}


class Refused(Exception):
    """The message is one line."""


def platform(wheel: Path) -> str:
    """Returns Blender's name of the platform of a wheel."""
    tag = wheel.stem.split("-")[-1]
    for pattern, name in PLATFORMS.items():
        if re.fullmatch(pattern, tag):
            return name
    raise Refused(f"{wheel.name}: Blender has no platform for the tag {tag}")


def check(wheel: Path, version: str) -> None:
    """Refuses a wheel of another package or version, and one that does not serve every Python of Blender."""
    if not wheel.is_file():
        raise Refused(f"{wheel}: not found")
    if not wheel.name.startswith(f"sscc-{version}-cp311-abi3-"):
        raise Refused(f"{wheel.name}: expected a wheel of sscc {version} for cp311-abi3")


def manifest(wheels: list[Path]) -> tuple[str, str]:
    """Returns the text of the manifest with these wheels, and the name of the file that it belongs into."""
    text = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8")
    facts = tomllib.loads(text)
    for wheel in wheels:
        check(wheel, facts["version"])
    names = sorted(wheel.name for wheel in wheels)
    platforms = sorted(platform(wheel) for wheel in wheels)
    if len(set(platforms)) < len(platforms):
        raise Refused(f"two wheels for one platform: {', '.join(names)}")
    lines = [f'    "./wheels/{name}",' for name in names]
    listed = "\n".join([f"platforms = [{', '.join(repr(p) for p in platforms)}]", "wheels = [", *lines, "]"])
    text, count = re.subn(r"^wheels = \[\]$", listed, text, flags=re.MULTILINE)
    if count != 1:
        raise Refused("blender_manifest.toml: expected one line 'wheels = []'")
    ending = f"-{platforms[0].replace('-', '_')}" if len(platforms) == 1 else ""
    return text, f"{facts['id']}-{facts['version']}{ending}.zip"


def build(out: Path, wheels: list[Path]) -> Path:
    """Writes the extension into a folder, and returns its path."""
    text, name = manifest(wheels)
    contents = {"blender_manifest.toml": text.encode()}
    for file in [*sorted(ADDON.glob("*.py")), *LICENCES]:
        contents[file.name] = file.read_bytes()
    for wheel in wheels:
        contents[f"wheels/{wheel.name}"] = wheel.read_bytes()
    out.mkdir(parents=True, exist_ok=True)
    part = out / f"{name}.part"
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in sorted(contents.items()):
            # Without the time of the file.
            archive.writestr(zipfile.ZipInfo(path), data, zipfile.ZIP_DEFLATED)
    return part.replace(out / name)


def main() -> int:
    parser = argparse.ArgumentParser(description="Packs the add-on into an extension of Blender.")
    parser.add_argument("--out", type=Path, required=True, help="folder of the zip file")
    parser.add_argument("wheels", type=Path, nargs="+", metavar="WHEEL", help="one for each platform")
    arguments = parser.parse_args()
    try:
        print(build(arguments.out, arguments.wheels))
    except (OSError, Refused) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
