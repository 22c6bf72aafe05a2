# SPDX-License-Identifier: MIT
"""The package gets the viewer's scripts from the source tree, if `npm run build` has made them in viewer/: notebooks need them."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

FILES = Path(__file__).resolve().parent.parent / "viewer" / "dist" / "page"


class BuildWithViewer(build_py):
    def run(self) -> None:
        super().run()
        to = Path(self.build_lib) / "meshhier" / "viewer"
        for name in ("meshhier-viewer.js.gz", "meshhier-ktx2.js.gz"):
            if (FILES / name).is_file():
                to.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(FILES / name, to / name)


setup(cmdclass={"build_py": BuildWithViewer})
