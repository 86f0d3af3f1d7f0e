"""The viewer: ``python viewer.py [SCENE]`` is ``radiosity view [SCENE]``; without a scene, on the Cornell box."""

import sys

from radiosity.cli import main

if __name__ == "__main__":
    sys.exit(main(["view", *sys.argv[1:]]))
