"""Columns of tables on where an error lives."""

from postprocess.compare.shares import ZONES
from postprocess.reports.sentences import zone_in_words

SHARES = {
    f"{kind}_share_{zone}": f"{title}, {zone_in_words(zone)}"
    for zone in ZONES
    for kind, title in (("error", "squared error"), ("area", "area"))
}
"""Columns and what stands above them; see `postprocess.compare.shares`."""
