from .lecture import Lecture as Lecture
from .lecture import Place as Place
from .lecture import Step as Step
from .runner import LectureWindow as LectureWindow
from .runner import export as export
from .runner import find as find
from .runner import names as names
from .runner import run as run
