"""External gear pumps and motors."""
