"""What charts must be like: the figures of standards, from data files with their sources."""

from survey.products.standards.norway import NorwegianRules, norwegian_rules
from survey.products.standards.orders import Order, orders

__all__ = ["NorwegianRules", "Order", "norwegian_rules", "orders"]
