"""What a scene needs: decided before the work, by tests that are sure."""

from .plan import Item, Plan, make_plan
from .work import plan

__all__ = ["Item", "Plan", "make_plan", "plan"]
