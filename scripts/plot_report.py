#!/usr/bin/env python3
"""Plots and page of `rosrun perennial_nav report`: plot_report.py OUT LATITUDE LONGITUDE RUN...

Each RUN is a folder written by `evaluate`, with strategies or --pairs; OUT holds comparisons.csv already. Latitude and longitude, in degrees, are of
where the images were taken: day and night go by the sun's elevation there.
"""
import base64
import csv
import datetime
import html
import json
import math
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.dates  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker  # noqa: E402

# Okabe and Ito's colours, which colour-blind people can tell apart, without the yellow that is too light for a line;
# then the same again, dashed.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
DASHES = ["-", "--", ":"]
MOST_CURVES = 12
RIGHT_PX = 35.0  # what a confidence is about
FEWEST_DRAWN = 5  # answers in a tenth of confidence; of fewer nothing can be seen
SEASONS = {12: "winter", 1: "winter", 2: "winter", 3: "spring", 4: "spring", 5: "spring",
           6: "summer", 7: "summer", 8: "summer", 9: "autumn", 10: "autumn", 11: "autumn"}
SEASON_COLOURS = {"winter": "#dfe9f5", "spring": "#e6f3e0", "summer": "#fdf6d8", "autumn": "#f8e7d8"}
# Day: the sun is up. Twilight: less than 6 degrees below the horizon (civil twilight).
LIGHTS = {"day": "full", "twilight": "left", "night": "none"}


class Run:
    def __init__(self, folder, site):
        self.name = os.path.basename(os.path.normpath(folder))
        self.label = self.name
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as stream:
            self.summary = json.load(stream)
        with open(os.path.join(folder, "errors.csv"), encoding="utf-8", newline="") as stream:
            self.rows = list(csv.DictReader(stream))
        self.of_pairs = bool(self.rows) and "map_traversal" in self.rows[0]
        self.lives = [(int(row["age_traversals"]), int(row["dropped"]), int(row["kept"]))
                      for row in rows_if_any(folder, "lives.csv")]
        self.costs = [(int(row["registration"]), float(row["registration_ms"]), float(row["learning_ms"]))
                      for row in rows_if_any(folder, "cost.csv")]
        for row in self.rows:
            row["time"] = parse_time(row["stamp"])
            row["light"] = light_at(row["time"], site)
            row["error"] = float(row["error_px"]) if row["error_px"] else None

    def absolute_errors(self):
        return sorted(abs(row["error"]) for row in self.rows if row["error"] is not None)

    def by_traversal(self):
        """(time, light, [signed errors]) of each traversal, in order of the traversals' names."""
        traversals = {}
        for row in self.rows:
            traversals.setdefault(row["traversal"], []).append(row)
        for name in sorted(traversals):
            rows = traversals[name]
            yield rows[0]["time"], rows[0]["light"], [row["error"] for row in rows if row["error"] is not None]


def rows_if_any(folder, name):
    """Rows of a table that not every run has."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def sun_elevation_deg(time, latitude_deg, longitude_deg):
    """Low-precision formulas of the Astronomical Almanac, section C; without refraction."""
    days = (time - datetime.datetime(2000, 1, 1, 12)).total_seconds() / 86400.0
    anomaly = math.radians(357.528 + 0.9856003 * days)
    longitude = math.radians(280.460 + 0.9856474 * days + 1.915 * math.sin(anomaly) + 0.020 * math.sin(2 * anomaly))
    obliquity = math.radians(23.439 - 4e-7 * days)
    right_ascension = math.atan2(math.cos(obliquity) * math.sin(longitude), math.cos(longitude))
    declination = math.asin(math.sin(obliquity) * math.sin(longitude))
    sidereal = math.radians(15.0 * (18.697374558 + 24.06570982441908 * days) + longitude_deg)
    latitude = math.radians(latitude_deg)
    return math.degrees(math.asin(
        math.sin(latitude) * math.sin(declination)
        + math.cos(latitude) * math.cos(declination) * math.cos(sidereal - right_ascension)))  # fmt: skip


def light_at(time, site):
    elevation = sun_elevation_deg(time, *site)
    return "day" if elevation > 0.0 else "twilight" if elevation > -6.0 else "night"


def parse_time(text):
    pattern = "%Y-%m-%dT%H:%M:%S.%fZ" if "." in text else "%Y-%m-%dT%H:%M:%SZ"
    return datetime.datetime.strptime(text, pattern)


def median(values):
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else (ordered[middle - 1] + ordered[middle]) / 2


def rank(run):
    """Best first: by the share within 20 px, then the mean error."""
    mean = run.summary["mean_error_px"]
    return (-run.summary["within_px"]["20"], mean if mean is not None else float("inf"))


def chosen(runs):
    """Runs to draw: all if they are few, else the best of each strategy, and the best of pairs."""
    if len(runs) <= MOST_CURVES:
        return sorted(runs, key=rank)
    best = {}
    for run in sorted(runs, key=rank):
        best.setdefault(run.name if run.of_pairs else run.summary["strategy"], run)
    return list(best.values())[:MOST_CURVES]


def shorten_labels(runs):
    """Labels without the settings that all runs share."""
    parts = [run.name.split(",") for run in runs]
    shared = set(parts[0][1:]).intersection(*(set(p[1:]) for p in parts))
    labels = [",".join(part for part in p if part not in shared) for p in parts]
    for run, label in zip(runs, labels):
        run.label = label if labels.count(label) == 1 else run.name


def set_ticks(axis, lower, upper):
    """Readable ticks for an axis that is linear about zero and logarithmic beyond."""
    steps = [value * 10 ** power for power in range(0, 4) for value in (1, 2, 5)]
    ticks = [0.5 * sign for sign in (-1, 1)] + [0] + [step * sign for step in steps for sign in (-1, 1)]
    axis.set_ticks(sorted(tick for tick in ticks if lower <= tick <= upper))
    axis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axis.set_minor_locator(matplotlib.ticker.NullLocator())


def styles(runs):
    return {run.name: {"color": COLOURS[i % len(COLOURS)], "linestyle": DASHES[i // len(COLOURS) % len(DASHES)]}
            for i, run in enumerate(runs)}


def legend(axes):
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8)


def plot_distribution(runs, axes):
    rows = []
    style = styles(runs)
    for run in runs:
        errors = run.absolute_errors()
        everything = max(1, sum(row["ground_truth_px"] != "" for row in run.rows))
        xs, ys = [0.0], [0.0]
        for i, error in enumerate(errors):
            xs += [error, error]
            ys += [i / everything, (i + 1) / everything]
        xs.append(1000.0)
        ys.append(len(errors) / everything)
        axes.plot(xs, ys, label=run.label, linewidth=1.8, **style[run.name])
        rows += [(run.name, "%.6g" % x, "%.6g" % y) for x, y in zip(xs, ys)]
    axes.set_xlim(0, 50)
    axes.set_ylim(0, 1.02)
    axes.set_xlabel("threshold of the error, px")
    axes.set_ylabel("share of all registrations within it")
    axes.set_title("Distribution of the error (a missing answer is never within)")
    axes.grid(alpha=0.3)
    legend(axes)
    return ("run", "threshold_px", "probability"), rows


def interval(right, count):
    """95 % interval of a share (Wilson, Journal of the American Statistical Association 1927)."""
    z = 1.96
    middle = (right + z * z / 2) / (count + z * z)
    half = z / (count + z * z) * math.sqrt(right * (count - right) / count + z * z / 4)
    return middle - half, middle + half


def plot_reliability(runs, axes):
    """Of the answers whose ground truth is known, in tenths of confidence; tenths of few answers in the table only."""
    rows = []
    style = styles(runs)
    axes.plot([0, 1], [0, 1], color="#888888", linewidth=0.8, label="as it should be")
    for run in runs:
        tenths = {}
        for row in run.rows:
            if row["error"] is not None:
                confidence = float(row["confidence"])
                tenths.setdefault(min(9, int(10 * confidence)), []).append((confidence, abs(row["error"]) <= RIGHT_PX))
        points = []
        for tenth, answers in sorted(tenths.items()):
            right = sum(is_right for _, is_right in answers)
            point = (mean([confidence for confidence, _ in answers]), right / len(answers), *interval(right, len(answers)))
            rows.append((run.name, tenth / 10, (tenth + 1) / 10, len(answers), *("%.6g" % value for value in point)))
            if len(answers) >= FEWEST_DRAWN:
                points.append(point)
        xs, ys = [p[0] for p in points], [p[1] for p in points]
        bars = [[max(0.0, p[1] - p[2]) for p in points], [max(0.0, p[3] - p[1]) for p in points]]
        axes.errorbar(xs, ys, bars, label=run.label, marker="o", markersize=5, linewidth=1.6, elinewidth=0.6, capsize=2,
                      **style[run.name])  # fmt: skip
    axes.set_xlim(0, 1.01)
    axes.set_ylim(0, 1.02)
    axes.set_xlabel("confidence (mean of each tenth)")
    axes.set_ylabel("share right within %g px" % RIGHT_PX)
    axes.set_title("Reliability of the confidence (bars: 95 % intervals; above the diagonal: too modest)")
    axes.grid(alpha=0.3)
    legend(axes)
    return ("run", "from", "to", "answers", "mean_confidence", "share_right", "low", "high"), rows


def mark_seasons(axes, times):
    day, last, named = min(times), max(times), set()
    while day <= last:
        following = (day.replace(day=1) + datetime.timedelta(days=32)).replace(day=1, hour=0, minute=0, second=0)
        season = SEASONS[day.month]
        axes.axvspan(day, min(following, last), color=SEASON_COLOURS[season], zorder=0,
                     label=None if season in named else season)
        named.add(season)
        day = following


def plot_time(runs, axes):
    rows, times = [], []
    style = styles(runs)
    for run in runs:
        many = len({row["traversal"] for row in run.rows}) > 60
        points = sorted((time, median([abs(e) for e in errors]), light) for time, light, errors in run.by_traversal()
                        if errors)  # fmt: skip
        for light, fill in LIGHTS.items():
            of_light = [p for p in points if p[2] == light]
            axes.plot([p[0] for p in of_light], [p[1] for p in of_light], linestyle="none", marker="o", markersize=3 if many else 5,
                      fillstyle=fill, markerfacecoloralt="none", color=style[run.name]["color"], alpha=0.25 if many else 0.45,
                      markeredgewidth=0.8, zorder=2)  # fmt: skip
            rows += [(run.name, p[0].isoformat() + "Z", light, "%.6g" % p[1]) for p in of_light]
        smooth = [median([p[1] for p in points[max(0, i - 4):i + 5]]) for i in range(len(points))]
        axes.plot([p[0] for p in points], smooth, linewidth=1.6, zorder=3, label=run.label, **style[run.name])
        times += [p[0] for p in points]
    if times:
        mark_seasons(axes, times)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(bottom=0)
    set_ticks(axes.yaxis, *axes.get_ylim())
    axes.xaxis.set_major_formatter(matplotlib.dates.ConciseDateFormatter(axes.xaxis.get_major_locator()))
    axes.set_xlabel("time; filled: day, half: twilight (sun 0 to 6 degrees below the horizon), open: night")
    axes.set_ylabel("median error of a traversal, px")
    axes.set_title("Error over time (lines: median of nine traversals)")
    axes.grid(alpha=0.3)
    legend(axes)
    return ("run", "time", "light", "median_error_px"), rows


def windows(run, key):
    """(traversal, signed errors of the last ten traversals) with the errors grouped by key(row)."""
    names = sorted({row["traversal"] for row in run.rows})
    errors = {name: [] for name in names}
    for row in run.rows:
        if row["error"] is not None:
            errors[row["traversal"]].append((key(row), row["error"]))
    for number in range(1, len(names) + 1):
        groups = {}
        for name in names[max(0, number - 10):number]:
            for group, error in errors[name]:
                groups.setdefault(group, []).append(error)
        if groups:
            yield number, list(groups.values())


def mean(values):
    return sum(values) / len(values)


def plot_signed(runs, axes, key, value, name):
    rows = []
    style = styles(runs)
    for run in runs:
        points = [(number, value(groups)) for number, groups in windows(run, key)]
        axes.plot([p[0] for p in points], [p[1] for p in points], label=run.label, linewidth=1.6, **style[run.name])
        rows += [(run.name, number, "%.6g" % y) for number, y in points]
    axes.axhline(0.0, color="#888888", linewidth=0.8)
    axes.set_xlabel("traversal")
    axes.grid(alpha=0.3)
    legend(axes)
    return ("run", "traversal", name), rows


def plot_drift(runs, axes):
    axes.set_ylabel("mean signed error of ten traversals, px")
    axes.set_title("Drift: where the frames of the maps go, all places together")
    return plot_signed(runs, axes, lambda row: "", lambda groups: mean(groups[0]), "mean_signed_error_px")


def plot_frames(runs, axes):
    """Places drift to different sides, so that their mean hides it."""
    axes.set_ylabel("mean over places, px")
    axes.set_title("Drift, place by place: magnitude of the mean signed error of ten traversals")
    return plot_signed(runs, axes, lambda row: row["distance_m"],
                       lambda groups: mean([abs(mean(group)) for group in groups]), "mean_frame_error_px")  # fmt: skip


def plot_lives(runs, axes):
    """Kaplan and Meier's estimate: features still there at the end lived at least so long."""
    rows = []
    style = styles(runs)
    for run in runs:
        at_risk = sum(dropped + kept for _, dropped, kept in run.lives)
        share, xs, ys = 1.0, [0], [1.0]
        for age, dropped, kept in run.lives:
            if at_risk > 0:
                share *= 1.0 - dropped / at_risk
            at_risk -= dropped + kept
            xs.append(age)
            ys.append(share)
        axes.step(xs, ys, where="post", label=run.label, linewidth=1.6, **style[run.name])
        rows += [(run.name, x, "%.6g" % y) for x, y in zip(xs, ys)]
    axes.set_ylim(0, 1.02)
    axes.set_xlabel("age, traversals")
    axes.set_ylabel("share of features that live longer")
    axes.set_title("How long features live")
    axes.grid(alpha=0.3)
    legend(axes)
    return ("run", "age_traversals", "share"), rows


def plot_cost(runs, axes):
    """Medians, because other programs disturb single measurements."""
    rows = []
    style = styles(runs)
    for run in runs:
        last = len(run.costs)
        edges = sorted({min(last, round(10 ** (step / 6.0))) for step in range(0, 30)} | {0}) if last else []
        xs, ys = [], []
        for begin, end in zip(edges, edges[1:]):
            some = run.costs[begin:end]
            xs.append(end)
            ys.append(median([cost[1] for cost in some]))
            rows.append((run.name, end, "%.6g" % ys[-1], "%.6g" % median([cost[2] for cost in some])))
        axes.plot(xs, ys, label=run.label, linewidth=1.6, marker=".", **style[run.name])
    axes.set_xscale("log")
    axes.set_ylim(bottom=0)
    axes.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axes.set_xlabel("registrations of the place so far")
    axes.set_ylabel("processor time per registration, ms")
    axes.set_title("Cost of a registration")
    axes.grid(alpha=0.3)
    legend(axes)
    return ("run", "registrations_to", "registration_ms", "learning_ms"), rows


def of_strategies(runs):
    return [run for run in runs if not run.of_pairs]


# Name, function, and the runs that have what it draws.
FIGURES = [("distribution", plot_distribution, lambda runs: runs),
           ("reliability", plot_reliability, lambda runs: [run for run in runs if run.of_pairs]),
           ("time", plot_time, of_strategies), ("drift", plot_drift, of_strategies), ("frames", plot_frames, of_strategies),
           ("lives", plot_lives, lambda runs: [run for run in runs if run.lives]),
           ("cost", plot_cost, lambda runs: [run for run in runs if run.costs])]


def write_csv(path, header, rows):
    with open(path, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(rows)


def draw(out, name, function, runs):
    figure, axes = plt.subplots(figsize=(10.5, 4.8), constrained_layout=True)
    header, rows = function(runs, axes)
    for kind in ("png", "svg"):
        figure.savefig(os.path.join(out, name + "." + kind), dpi=110)
    plt.close(figure)
    write_csv(os.path.join(out, name + ".csv"), header, rows)
    with open(os.path.join(out, name + ".png"), "rb") as stream:
        picture = base64.b64encode(stream.read()).decode()
    return '<p><img alt="%s" src="data:image/png;base64,%s"></p>' % (name, picture)


def number(value, digits=2):
    return "" if value is None else "%.*f" % (digits, value)


def table(header, rows):
    def cells(tag, values):
        return "<tr>" + "".join("<%s>%s</%s>" % (tag, html.escape(str(value)), tag) for value in values) + "</tr>"

    return "<table>" + cells("th", header) + "".join(cells("td", row) for row in rows) + "</table>"


def table_of_runs(out, runs):
    header = ["run", "registrations", "answered %", "within 5 px %", "10", "20", "35", "50", "at 99 % precision %", "mean px",
              "median px", "mean signed px", "ms per registration", "ms per extraction"]
    rows = []
    for run in sorted(runs, key=rank):
        s = run.summary
        rows.append([run.name, s["registrations"], number(100 * s["answered"], 1)] +
                    [number(100 * s["within_px"][key], 1) for key in ("5", "10", "20", "35", "50")] +
                    [number(100 * s["answered_at_99_precision"], 1) if run.of_pairs else "", number(s["mean_error_px"]),
                     number(s["median_error_px"]), number(s.get("mean_signed_error_px")), number(s["ms_per_registration"]), number(s["ms_per_extraction"])])
    write_csv(os.path.join(out, "runs.csv"), header, rows)
    return table(header, rows)


def table_by_light(out, runs):
    """Shares within 20 px by day, in twilight and at night."""
    header = ["run"] + ["%s %%" % light for light in LIGHTS] + ["%s, registrations" % light for light in LIGHTS]
    rows = []
    for run in runs:
        shares, counts = [], []
        for light in LIGHTS:
            errors = [row["error"] for row in run.rows if row["light"] == light]
            counts.append(len(errors))
            within = sum(error is not None and abs(error) <= 20.0 for error in errors)
            shares.append(number(100.0 * within / len(errors), 1) if errors else "")
        rows.append([run.name] + shares + counts)
    write_csv(os.path.join(out, "light.csv"), header, rows)
    return table(header, rows)


def probability(text):
    value = float(text)
    return "&lt; 0.0001" if value < 1e-4 else "%.4f" % value


def table_of_comparisons(out, drawn):
    names = {run.name for run in drawn}
    lines = ["<table><tr>" + "".join("<th>%s</th>" % cell for cell in (
        "a", "b", "pairs", "only b answered", "only a answered", "neither", "mean difference a - b, px", "95 % interval",
        "p", "p after Holm")) + "</tr>"]
    with open(os.path.join(out, "comparisons.csv"), encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            if row["a"] not in names or row["b"] not in names:
                continue
            cells = [html.escape(row["a"]), html.escape(row["b"]), row["pairs"], row["missing_a"], row["missing_b"],
                     row["missing_both"], "%.2f" % float(row["mean_difference_px"]),
                     "%.2f to %.2f" % (float(row["low_px"]), float(row["high_px"])), probability(row["p"]),
                     probability(row["p_holm"])]
            lines.append("<tr>" + "".join("<td>%s</td>" % cell for cell in cells) + "</tr>")
    return "".join(lines) + "</table>"


STYLE = """body { font-family: sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; }
img { max-width: 100%; } table { border-collapse: collapse; font-size: 85%; }
th, td { border-bottom: 1px solid #ccc; padding: 0.25em 0.6em; text-align: right; }
th:first-child, td:first-child { text-align: left; }"""


def page(out, runs):
    drawn = chosen(runs)
    shorten_labels(drawn)
    title = "Map strategies compared" if of_strategies(runs) else "Registrations compared"
    parts = ["<h1>%s</h1>" % title,
             "<p>%d runs on: %s.</p>" % (len(runs), html.escape("; ".join(sorted({r.summary["input"] for r in runs}))))]
    if len(drawn) < len(runs):
        parts.append("<p>Drawn and compared below is the best run of each strategy (by the share within 20 px, then "
                     "the mean error); the table holds all of them, comparisons.csv all pairs.</p>")
    parts += [draw(out, name, function, fitting(drawn)) for name, function, fitting in FIGURES if fitting(drawn)]
    parts += ["<h2>By day and night</h2>", "<p>Shares within 20 px. Day: the sun is up; twilight: it is less than 6 degrees "
              "below the horizon.</p>", table_by_light(out, drawn)]
    parts += ["<h2>All runs</h2>", "<p>Shares are of all registrations: a missing answer counts as wrong. Means and the "
              "median are over the answered ones.</p>", table_of_runs(out, runs)]
    parts += ["<h2>Paired t-tests</h2>", "<p>Absolute errors, over the registrations that both runs answered; the others "
              "are counted. The plain p-value is what the literature reports; Holm's correction accounts for the number "
              "of comparisons.</p>", table_of_comparisons(out, drawn)]
    with open(os.path.join(out, "report.html"), "w", encoding="utf-8") as stream:
        stream.write("<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>%s"
                     "</title><style>%s</style></head><body>%s</body></html>" % (title, STYLE, "\n".join(parts)))


def main(arguments):
    if len(arguments) < 4:
        print(__doc__, file=sys.stderr)
        return 2
    site = (float(arguments[1]), float(arguments[2]))
    page(arguments[0], [Run(folder, site) for folder in arguments[3:]])
    print(os.path.join(arguments[0], "report.html"))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
