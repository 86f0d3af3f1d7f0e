"""The viewer: ``python viewer.py [SCENE]`` is ``radiosity view --or-pictures [SCENE]``; by default, the Cornell box."""

import sys

from radiosity.cli import main

if __name__ == "__main__":
    sys.exit(main(["view", "--or-pictures", *sys.argv[1:]]))
