"""Numbers in running prose that a table or a console block of the pages shows as well: both say the same.

Tables and blocks are made by their commands and compared in CI (``tools/documented.py``). Each function here is named
after a page and says its sentences again, with the numbers that the tables give today. Where a sentence is
missing, change it on the page; where its words were changed, change them here.
"""

import math
import re
import tomllib

import numpy as np
import pytest

from tests.docs.prose import between, firsts, given, said, shown, table, untold
from tests.docs.scripts import ROOT, imported


def actuators():
    maps = table("docs/actuators.md", "motor", "gearboxes under `paper`")
    changes = table("docs/actuators.md", "change", "gearboxes").set_index("change")
    friction = table("docs/bench.md", "friction coefficient", "0.3").iloc[0]
    printed = table("docs/bench.md", "what", "predicted").set_index("what").measured["7.2:1, friction coefficient"]
    ours = maps.set_index("motor")["under `iso6336`"]["VT8020"]
    grams = changes["mass, mean change"]["no profile shift"].removeprefix("+")
    yield f"without shift there are {changes.gearboxes['no profile shift']} gearboxes, {grams} heavier"
    winners = (
        table("docs/actuators.md", "of the winners of six motors").set_index("of the winners of six motors").figure
    )

    def share(row):
        some, of_all = (float(number) for number in re.findall(r"(\d+) of (\d+)", winners[row])[0])
        return some / of_all

    assert winners["of module 0.5 mm"].endswith(f" of {maps['under `iso6336`'].sum()}")
    assert share("with profile shift, of the VT8020") > 0.5  # most
    assert share("ring in the planets' roots with standard tips") == pytest.approx(2 / 3, abs=0.05)
    assert share("the same with straight planets") == pytest.approx(0.8, abs=0.05)
    crowned = share("$K_{H\\beta}$ at the sun")
    yield f"above 2 in one of {1.0 / crowned:.0f} gearboxes instead of four of five"
    yield f"none of their {maps['gearboxes under `paper`'].sum()} winners overlaps"
    yield f"the map of the VT8020, which has {ours} gearboxes"
    yield (
        f"lost {friction['measured'].split()[0]} percent under load together, which a friction coefficient of "
        f"{printed.split(',')[0]} in the teeth explains"
    )
    yield f"configuration gives {friction['0.3']} percent for two"
    yield f"in a closed case, the U8 holds it for {shown('docs/actuators.md', 'continuous torque')[-1]:.0f} s"


def bench():
    cells = table("docs/bench.md", "actuator", "load cell")
    found = table("docs/bench.md", "what", "predicted").set_index("what")
    losses, electrical = (
        table("docs/bench.md", "friction coefficient"),
        table("docs/bench.md", "actuator", "voltage drop, V"),
    )
    machined = table("docs/bench.md", "ratio", "together, %")["together, %"]
    drops, ohms = firsts(electrical["voltage drop, V"]), firsts(electrical["resistance, ohm"])
    more = 100.0 * (firsts(electrical["torque over command"]) - 1.0)
    over = ohms / electrical["data sheet, ohm"]
    heavy = cells[cells["commanded, N m"] >= 4]["load cell over braking motor"]
    yield f"lose {losses['measured'][0]} percent under load and " + (
        f"{found.measured['7.2:1, friction of both without load, N m']} N m without"
    )
    coefficient = found.measured["7.2:1, friction coefficient"].split(",")[0]
    yield f"a friction coefficient of {coefficient} in the teeth"
    yield f"both motors make {more[0]:.0f} and {more[1]:.0f} percent *more*"
    yield f"the drives take {drops.mean():.1f} V times the motor's current"
    yield f"one winding has {over[0]:.2f} times the resistance of its data sheet"
    yield f"The package's lose {between(machined, 1)} percent at the peak torque"
    yield f"The package's {between(machined, 1)} percent lie within 1.5 to 5"
    causes = table("docs/bench.md", "missing", "(d) at least, at most")
    least = firsts(causes["(d) at least, at most"]) / causes["missing"]
    assert (least > 0.5).eq(causes["commanded, N m"] >= 6).all()
    yield "From 6 N m on, more than half of what is missing is (d), whichever actuator the friction is in"
    catalogue = table("docs/bench.md", "gearbox", "loss at full load, %").set_index("gearbox")["loss at full load, %"]
    assert catalogue["PLE060"] == catalogue["PLE080"]
    yield f"Machined planetary stages of this size lose {catalogue['PLE060']} percent by catalogue"
    ends = [float(x) for cell in catalogue for x in re.findall(r"[\d.]+", cell)]
    yield f"percent lie within {min(ends):g} to {max(ends):g}. Friction"
    yield f"the load cell reads {between(heavy, 2)} of the braking motor's torque from 4 N m on"
    yield f"with 1.6 the windings would have {1.6 * over[0]:.1f} and {1.6 * over[1]:.1f} times the resistance"
    yield f"so it is theirs, and {100.0 * drops.mean() / 48.0:.1f} percent of the bus"
    yield f"The MN8014 has {over[0]:.2f} times its data sheet's {electrical['data sheet, ohm'][0]}"
    sessions = [found.loc[f"14:1, session {one}, with that coefficient: loss of both under load, %"] for one in "AB"]
    loss, told = firsts(one.measured for one in sessions), [float(x) for x in sessions[0].predicted.split(" to ")]
    yield f"the sessions below differ by {loss[0] - loss[1]:.0f} percent"
    yield f"The 14:1 actuator loses {loss[1] / told[1]:.1f} to {loss[0] / told[0]:.1f} times what the coefficient"
    idle = found.loc["7.2:1, friction of both without load, N m"]
    yield f"the first is {float(idle.predicted) / float(idle.measured.split()[0]):.1f} times too large for one"


def getting_started():
    high, stands, rise = (shown("docs/getting_started.md", "paper's Case C, simulated here")[k] for k in (0, 2, 3))
    one = shown("docs/getting_started.md", "0.9 m")
    yield f"of Case C's {high:.3f} m, {stands:.3f} m is the base"
    yield f"its centre of mass rises by {rise:.3f} m"
    yield f"A knee gearbox of {one[7]:.2f}:1 is heavier"
    yield f"At 0.9 m, the design of least mechanical energy takes {one[8]:.0f} percent more from the battery"


def legs():
    series = table("docs/legs.md", "series", "as given, 5 to 95 %").set_index(["series", "quantity"])
    terms = table("docs/legs.md", "drives", "term", "fitted on").set_index(["drives", "term", "fitted on"]).sort_index()
    speeds = series.xs("take-off, m/s", level="quantity")
    given, clocked = firsts(speeds["as given, 5 to 95 %"]), firsts(speeds["measured"])
    with imported("rail_legs") as script:
        encoders = script.ENCODERS
    off = {key: float(cell) for key, cell in series["error, %"].items() if cell != "fitted"}
    yield f"take-off speeds are {between(100.0 * (given / clocked - 1.0))} percent too high"
    second = max(abs(off[2, "take-off, m/s"]), abs(off[2, "apex of the hip, m"]))
    yield (
        f"take-off speed and apex of series 2 are within {math.ceil(second)} percent, and the apex of series 1 within "
        f"{math.ceil(abs(off[1, 'apex of the hip, m']))}."
    )
    first = firsts(speeds["fitted, 5 to 95 %"])[0]
    yield (
        f"series 1 is {-off[1, 'take-off, m/s']:.0f} percent below that by flight time and "
        f"{100.0 * (1.0 - first / encoders[0]):.0f} percent below that by the same log's encoders"
    )
    apart = clocked - np.array(encoders)
    yield f"differ by {apart[0]:.2f} m/s there, and by {apart[1:].max():.2f} m/s at most in the others"
    means, times = ([f"{speed:.2f}" for speed in speeds] for speeds in (encoders, clocked))
    yield f"is {', '.join(means[:2])} and {means[2]} m/s in the mean of the hops"
    yield f"where flight times say {', '.join(times[:2])} and {times[2]}"
    misses = [
        max(abs(firsts([cell])[0]) for cell in row[-2:])  # take-off of series 2 and 3
        for (drives, term, _), row in zip(terms.index, terms.to_numpy(), strict=True)
        if drives == "elastic" and term != "damping"
    ]
    yield f"miss the take-off speed of series 2 or 3 by {between(misses)} percent"
    yield f"Push times of series 2 and 3 are {off[2, 'push, s']:.0f} and {off[3, 'push, s']:.0f} percent too long"
    damping = firsts(terms.loc[("elastic", "damping")]["value"])
    (published,) = re.findall(r"0.093 N m and ([\d.]+) N m s/rad", said("docs/legs.md"))
    assert round(max(damping) / float(published)) == 4
    yield f"A damping of {damping[1:].mean():.2f} N m s/rad is four times the published viscous friction"
    yield (
        f"damping is the same within {math.ceil(100.0 * abs(damping[2] / damping[1] - 1.0))} percent, "
        f"{damping[1:].mean():.2f} N m s/rad. Fitted to the flight time of series 1 it is {damping[0]:.2f}"
    )
    rigid = firsts([terms.loc[("rigid", "damping", 3)].iloc[2]])[0]
    yield f"with rigid ones, what fits series 3 misses series 2 by {abs(rigid):.0f} percent"


def losses():
    found = table("docs/losses.md", "losses", "hip ratio").set_index(["losses", "height, m"])
    knees, tops = (
        {name: row for (name, at), row in found.iterrows() if at.startswith(start)} for start in ("knee", "highest")
    )
    peaks = {name: float(at.split()[1]) for name, at in found.index if at.startswith("highest")}

    def more(setting, at, column="energy, J"):
        return 100.0 * (float(found[column][setting, at]) / float(found[column]["machined", at]) - 1.0)

    printed, rubbing = [more("printed", at) for at in ("0.7", "0.9", "1.1")], "as the public leg"
    yield f"Printed gears cost {between(printed)} percent more mechanical energy at one height"
    battery = [more(rubbing, at, "from the battery, J") for at in ("0.9", "1.1")]
    yield (
        f"0.9 m costs {more(rubbing, '0.9'):.0f} percent more and 1.1 m {more(rubbing, '1.1'):.0f} percent more, "
        f"{battery[0]:.0f} and {battery[1]:.0f} percent more from the battery"
    )
    dearer = float(tops[rubbing]["energy, J"]) / float(tops["machined"]["energy, J"]) - 1.0
    yield (
        f"The highest jump is {1e3 * (peaks['machined'] - peaks[rubbing]):.0f} mm lower and takes "
        f"{100.0 * dearer:.0f} percent more"
    )
    yield f"the knee's ratio falls from {knees['machined']['knee ratio']} to {knees[rubbing]['knee ratio']}"


def model():
    def thirds(row, column):
        return [float(x) for x in row.iloc[column].split(" / ")]

    steps = table("docs/model.md", "integrator", "speed").set_index(["integrator", "step ms"])
    assert steps["speed"]["RK4", 2] == pytest.approx(0.5, abs=0.1)  # half as fast
    assert steps["speed"]["Euler", 2] == pytest.approx(2.0, abs=0.2)  # nearly twice
    usual = steps.loc[("Euler", 1)]
    yield f"the error of the step, {thirds(usual, 3)[1]:.2f} mm and {thirds(usual, 4)[1]:.2f} percent"
    reads = table("docs/model.md", "controller reads").set_index("controller reads").loc["the state"]
    yield f"takes {thirds(reads, 1)[0]:.1f} percent less energy than a converged"
    stop = table("docs/model.md", "stop", "w, rad").iloc[:, 4:]
    full, mean = stop.max()
    yield f"off by at most {full} percent of the torque at the full travel, and by {mean} percent in the mean"
    jumps = table("docs/model.md", "design", "with", "chain N").set_index(["with", "design"])
    before, after = jumps.loc["`reference-3`"], jumps.loc["friction: `reference`"]
    higher = 1e3 * (after["height m"] - before["height m"]).abs().max()
    harder = between(after["chain N"] / before["chain N"], 1)
    yield f"pulls {harder} times as hard as with rigid drives, while heights change by {higher:.0f} mm"
    closed = [float(cell.split()[0]) for cell in table("docs/model.md", "case", "open")["open"]]
    yield f"the balance closes to {max(closed):.2f} % on the paper's designs"
    fit = table("docs/model.md", "case", "paper", "5 to 95 %").set_index("case")
    off = max(abs(float(cell.strip("%"))) for column in (3, 7) for cell in fit.iloc[:, column - 1])
    yield f"All eight numbers are within {off} %"
    heights, joules = fit["height m"], fit["energy J"]
    assert heights["A"] < heights["C"] < heights["B"]
    a, b, c = (f"({heights[case]:.3f} m)" for case in "ABC")
    yield f"here B {b} is higher than C {c}, and A {a} is lowest"
    less = 100.0 * (1.0 - joules["C"] / joules["nominal"])
    yield f"Case C takes {less:.0f} % less energy than nominal, as in the paper"

    searched = table("docs/model.md", "published", "front: least J there").set_index("case")
    told = {case: float(cell.split(", ")[1].split()[0]) for case, cell in searched["published"].items()}
    found = searched.iloc[:, 3].astype(float)
    off = {case: 100.0 * (found[case] / told[case] - 1.0) for case in "ABC"}
    yield (
        f"on {-off['A']:.0f} percent less than published for Case A, {-off['B']:.0f} percent less for B, "
        f"and {off['C']:.0f} percent more for C"
    )


def landing():
    told = table("docs/landing.md", "fall, m", "time to rest, s")
    yield f"meet the floor with {between(np.sqrt(2.0 * 9.81 * told['fall, m']), 1)} m/s"
    seconds = 60.0 / table("docs/landing.md", "hops per minute")["hops per minute"]
    assert seconds.round().eq(2.0).all()
    yield f"a hop takes about 2 s, of which {between(told['time to rest, s'], 1)} are"
    assert table("docs/landing.md", "survive their landing")["survive their landing"][0] == 0  # no design tried does


def limit():
    gaps = [
        shown("docs/limit.md", f"{trial} ")[6]
        for trial in re.findall(
            r"^ +(\d+) +\d\.\d{3} +\d", (ROOT / "docs" / "limit.md").read_text(encoding="utf-8"), re.M
        )
    ]
    assert len(gaps) == 4
    yield f"On the hardware of [four designs](#the-limit-of-a-design) it saves {between(gaps)} percent"
    built = table("docs/limit.md", "motor, design", "as built, m")
    shares = [[float(cell) for cell in row.split(" / ")] for row in built["high, %"]]
    assert {tuple(float(cell) for cell in row.split(" / "))[2] for row in built["hold, %"]} == {100.0}
    yield f"With `tracking`, {between(row[2] for row in shares)} percent of the robots are high"
    yield f"all are held, where {between(row[1] for row in shares)} percent are high"
    pairs = [[float(cell) for cell in row.split(" / ")] for row in built["energy, J"]]
    more = [100.0 * (tracking / time - 1.0) for time, tracking in pairs]
    yield f"for {-min(more):.0f} percent less to {max(more):.0f} percent more energy"
    apart = table("docs/limit.md", "collocation, J", "apart")["apart"]
    yield f"agree within {math.ceil(max(abs(firsts(apart))))} percent on five designs"
    first = table("docs/limit.md", "best torque, J", "quarter step, %")
    steps = first[["half step, %", "quarter step, %"]].abs().to_numpy().max()
    yield f"change by less than {math.ceil(100.0 * steps) / 100.0:.2f} percent with half"
    highest = table("docs/limit.md", "greatest height", "quarter step").iloc[0]
    joules = np.array([float(cell.split()[3]) for cell in highest.iloc[2:]])
    off = 100.0 * abs(joules[1:] / joules[0] - 1.0).max()
    yield f"at the greatest height by less than {math.ceil(10.0 * off) / 10.0:.1f} percent"
    tracked = table("docs/limit.md", "tracking, J", "gap, %").set_index("design")["tracking, J"]
    assert tracked["paper's C"] < first.set_index("design")["best torque, J"]["paper's C"]
    yield f"Each search has {given('docs/limit.md', 'limit_reference_3.py', 'jumps'):,} jumps and one seed"
    many = table("benchmarks/search_landscapes.md", "study", "its time").set_index("study")
    ours, plain = firsts(many.loc["torque over time"].iloc[1:3])
    yield f"{100.0 * (ours / plain - 1.0):.0f} percent more than `nsga2`"
    less = table("docs/limit.md", "virtual leg, J", "less, %").iloc[:, 3]
    heights = table("docs/limit.md", "virtual leg, J", "less, %").iloc[:, 0]
    savings = {at: float(cell) for at, cell in zip(heights, less, strict=True) if cell != "-"}
    some = [savings[at] for at in savings if 0.9 <= float(at) <= 1.2]
    yield f"and a search of hardware and profile together {between(list(savings.values()))} percent"
    yield f"the front lies {np.mean(some):.0f} percent below that of the paper's controller from 0.9 to 1.2 m"


def scaling():
    costs = table("docs/scaling.md", "algorithm", "together, ms").set_index("algorithm")["together, ms"]
    tasks = table("docs/scaling.md", "task", "sent, bytes").set_index("task").sum(axis=1)
    one, built = tasks["278 jumps"] / 278, tasks["256 jumps of a design as built"] / 256
    took = [float(x) for x in re.findall(r"and ([\d.]+) to ([\d.]+) ms of the scheduler", said("docs/scaling.md"))[0]]
    task_ms = np.mean(took)
    yield f"one scheduler hands out about {1e3 / task_ms:.0f} tasks per second"
    yield f"A jump therefore takes about {round(one, -2):.0f} bytes, and one as built {round(built, -1):.0f}"
    jump = table("docs/scaling.md", "algorithm", "jump, ms").set_index("algorithm")["jump, ms"]
    yield f"A jump takes about {jump.median():.0f} ms of a core"
    jump, carried = jump["`surrogate`"], round(1e9 / 8 / built, -5)
    yield f"A generation of 200 designs is about {0.2 * jump:.1f} s of jumps on one core"
    yield f"carries {carried:,.0f} jumps per second, which is the work of {round(carried * jump * 1e-3, -2):.0f} cores"
    last = table("docs/scaling.md", "generation", "bytes per row").iloc[-1]
    yield f"on one core, and its file {last['bytes per row'] * 0.1:.0f} GB"
    yield f"256 jumps take {round(256 * jump, -1):.0f} ms of the workers, three tasks take {3 * task_ms:.0f} ms of"
    yield f"Toward 100,000,000 evaluations, jumps take {1e8 * jump / 3.6e6:.0f} core hours"
    (statistics_ms,) = re.findall(r"256 jumps, costs the coordinator ([\d.]+) ms", said("docs/scaling.md"))
    limits = table("docs/scaling.md", "work", "first limit").set_index("first limit")["at about"]
    cores = 256 * jump / (3 * task_ms)
    assert limits["the scheduler, with three tasks per design"] == f"{round(cores, -1):.0f} cores"
    cores = 256 * jump / float(statistics_ms)
    assert limits["the coordinator's statistics"] == f"{round(cores, -1):.0f} cores"
    export = (
        table("docs/scaling.md", "share of one cold call, Case C")
        .set_index("share of one cold call, Case C")
        .iloc[:, 0]
    )
    export = export.str.removesuffix(" s").astype(float)
    yield f"Case C takes {export.sum():.0f} s of processor time in all formats"
    assert export.iloc[0] / export.sum() == pytest.approx(0.1, abs=0.02)  # a tenth
    spared = sum(seconds for name, seconds in export.items() if name.startswith(("`assembly`", "`pdf`")))
    yield f"(`--no-drawings --no-assembly`) saves {spared:.1f} s"
    read = table("docs/scaling.md", "command", "CPU, s, 1,000,000 evaluations").set_index("command").iloc[:, -1]
    yield f"`report` reads it in {1e-3 * read['`report`']:.1f} GB of memory"
    fronts = {
        name: shown(f"docs/{page}.md", "front: ")[0] for name, page in (("quick", "choosing"), ("case_c", "limit"))
    }
    for name, designs in fronts.items():
        budget = tomllib.loads((ROOT / "studies" / f"{name}.toml").read_text(encoding="utf-8"))["evaluations"]
        assert designs / budget == pytest.approx(0.45, abs=0.05)
    yield "four to five in ten of its evaluations are on it"
    hours = costs * 1e8 / 3.6e6
    yield f"would take {hours['`surrogate`']:.0f} hours with `surrogate` and {hours['`nsga2`']:.0f} hours with `nsga2`"
    yield (
        f"every study takes {costs['`surrogate`'] * 1e6 / 6e4:.0f} minutes of its coordinator and "
        f"{last['bytes per row'] * 1e-3:.1f} GB"
    )


PAGES = [actuators, bench, getting_started, landing, legs, limit, losses, model, scaling]


@pytest.mark.parametrize("page", PAGES, ids=lambda one: one.__name__)
def test_the_prose_says_what_the_tables_show(page):
    assert untold(f"docs/{page.__name__}.md", page()) == []
