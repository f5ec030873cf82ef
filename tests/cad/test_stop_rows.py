"""The parts list has the end stops, as something that can be bought or made."""

import csv
import io

from pareto_monoped.cad.write.tables import parts_list


def test_the_parts_list_has_the_end_stops(product):
    rows = {row["part"]: row for row in csv.DictReader(io.StringIO(parts_list(product)))}
    bumpers = [row for name, row in rows.items() if "_bumper_" in name]
    assert sum(int(row["count"]) for row in bumpers) == 4
    for row in bumpers:
        assert row["made_or_bought"] == "bought"
        assert row["material"] == "fluoroelastomer"
        bar_mm = 28 if "knee" in row["part"] else 20
        assert row["note"].startswith(f"round bar FKM 75 Shore A, {bar_mm} mm, cut to 28 mm; bonded to the floor of ")
        assert row["note"].partition(" the floor of ")[2].split()[0] in rows
        assert row["size_mm"].endswith(" x 28.0")
    for name, unit, count in (
        ("knee_seat_extension", "thigh", 1),
        ("knee_seat_flexion", "thigh", 1),
        ("hip_striker_front", "thigh", 1),
        ("hip_striker_rear", "thigh", 1),
        ("hip_seat_front", "base_frame", 1),
        ("hip_seat_rear", "base_frame", 1),
        ("knee_striker", "shank", 1),
        ("knee_striker_bolt", "shank", 2),
        ("hip_seat_screw", "base_frame", 2),
    ):
        assert (rows[name]["used_in"], int(rows[name]["count"])) == (unit, count), name
