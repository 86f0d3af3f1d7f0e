"""Where a solution is shown: in a window, or as the page inside a notebook."""

from __future__ import annotations

import html
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..solution import Solution

HEIGHT = 760  # pixels, of the page inside a notebook


def in_notebook() -> bool:
    """Whether this Python is the kernel of a notebook (Jupyter, VS Code, Colab, …), which can show HTML.

    IPython is asked only if it is loaded already: a program that never heard of it is in no notebook. Its terminal has
    no kernel.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return getattr(shell, "kernel", None) is not None


def show(solution: Solution, *, height: int = HEIGHT, **settings: Any) -> None:
    """Show a solution: as the page inside a notebook, else in a window, and wait until that is closed.

    Parameters
    ----------
    solution : Solution
    height : int, optional
        Of the page inside a notebook, pixels.
    **settings
        Fields of `ViewState` to begin with; inside a notebook also ``title``, ``caption`` and ``wrong`` of
        `radiosity.viewer.page.write_page`.

    Raises
    ------
    DisplayError
        Neither notebook nor display.
    ParameterError
        A setting that the window, or the page, does not have.
    """
    if not in_notebook():
        from .window import view

        view(solution, **settings)
        return
    from IPython.display import display

    text = f"{solution.scene.name}: {len(solution.patches):,} patches; {solution.status}"
    display({"text/html": frame(solution, height, **settings), "text/plain": text}, raw=True)


def frame(solution: Solution, height: int = HEIGHT, **settings: Any) -> str:
    """The page as HTML that can stand inside another page, which it can neither read nor change.

    Parameters
    ----------
    solution : Solution
    height : int, optional
        Pixels.
    **settings
        As `radiosity.viewer.page.page` takes them.
    """
    from .page import page

    inside = html.escape(page(solution, **settings), quote=True)
    return (
        f'<iframe srcdoc="{inside}" sandbox="allow-scripts" title="Light, bounce by bounce" '
        f'style="width: 100%; height: {height}px; border: 0; border-radius: 8px"></iframe>'
    )
