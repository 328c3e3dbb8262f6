"""What scripts/performance measures of whole queries, a server under load, and many places, and the tables of these."""
import json
import shlex
import statistics
import subprocess
import tempfile
import time
import pathlib

PLACES = ("office", "lobby", "hall")
STAGES = ("preprocess", "keypoints", "describe", "match", "pose", "icp", "verify", "total")
SCALE = {"scale": ("200000", ["10", "100", "1000"]), "scale-small": ("20000", ["10", "1000"])}


def measure_query(program, file):
    """Twelve frames of a place of each kind, asked of a warm server by its client, twice; of the second time the medians."""
    rows = []
    for kind in PLACES:
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder) / "place"
            run = lambda *command, **more: subprocess.run(command, check=True, capture_output=True, text=True, **more)
            run(program / "landmarkdb-generate", "place", "--type", kind, "--points", "2800000", "--seed", "60001",
                "--queries", "12", "--organised", "--out", place)
            index = shlex.split(json.loads((place / "manifest.json").read_text())["index_command"])
            run(program / index[0], *index[1:], cwd=place)
            rows.append({"place": kind, **medians_of(program, place, folder)})
    file.write_text(json.dumps({"threads": 2, "seed": 60001, "rows": rows}, indent=1))


def medians_of(program, place, folder):
    socket = pathlib.Path(folder) / "socket"
    client = [program / "landmarkdb", "--server", f"unix:{socket}"]
    server = subprocess.Popen([program / "landmarkdb-server", "--db", place / "places.db", "--threads", "2",
                               "--listen", "none", "--unix", socket], stderr=subprocess.DEVNULL)
    try:
        for _ in range(600):
            if subprocess.run([*client, "health"], capture_output=True).returncode == 0:
                break
            time.sleep(0.1)
        for _ in range(2):
            answers = [json.loads(subprocess.run([*client, "query", query, "--json"], capture_output=True, text=True).stdout)
                       for query in sorted(place.glob("query-*.pcd"))]
    finally:
        server.terminate()
        server.wait()
    return {"frames": len(answers), "localized": sum(a["status"] == "localized" for a in answers),
            **{stage: statistics.median(a["timing_ms"][stage] for a in answers) for stage in STAGES}}


def measure_load(program, file):
    subprocess.run([program / "landmarkdb-bench-load", "--seconds", "8", "--json", file], check=True)


def measure_scale(name):
    def measure(program, file):
        points, sizes = SCALE[name]
        databases = file.parent / f"places-of-{points}"
        databases.mkdir(exist_ok=True)
        subprocess.run([program / "landmarkdb-bench-scale", "--places", *sizes, "--points", points, "--frames", "20",
                        "--strangers", "40", "--keep", databases, "--json", file], check=True)
    return measure


def query_table(data, machine):
    lines = ["| place | preprocess | keypoints, describe | match | pose | icp | verify | total ms | localized |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for row in data["rows"]:
        described = row["keypoints"] + row["describe"]
        lines.append(f"| {row['place']} | {row['preprocess']:.0f} | {described:.0f} | {row['match']:.0f} | {row['pose']:.0f} | "
                     f"{row['icp']:.0f} | {row['verify']:.0f} | {row['total']:.0f} | {row['localized']} of {row['frames']} |")
    return lines + ["", f"{machine}; {data['threads']} threads, seed {data['seed']}."]


def load_table(data, machine):
    def line(name, figures, resident):
        return (f"| {name} | {figures['per_second']:.1f} | {figures['p50_ms']:.0f} | {figures['p95_ms']:.0f} | "
                f"{figures['p99_ms']:.0f} | {figures['answered']} | {figures['refused']} | {figures['failed']} | {resident} |")

    lines = ["| clients | answers a second | p50 ms | p95 ms | p99 ms | answered | refused | failed | server's memory, MB |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
             f"| (start) | | | | | | | | {data['resident_mb'][0]:.0f} |"]
    lines += [line(row["clients"], row, f"{row['resident_mb']:.0f}") for row in data["clients"]]
    fairness = data["fairness"]
    for name, key in (("2 light alone", "light_alone"), ("2 light beside heavy", "light_beside_heavy"),
                      ("heavy", "heavy")):
        lines.append(line(name, fairness[key], f"{data['resident_mb'][-1]:.0f}"))
    return lines + ["", f"{machine}; seed {data['seed']}."]


def scale_table(data, machine):
    lines = ["| places | keypoints | median ms | p95 ms | matching | poses | else | localized | of them the right place | "
             "and pose | frames of other places localized | ready s | resident MB | file MB |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for row in data["rows"]:
        lines.append(f"| {row['places']:,} | {row['keypoints']:,} | {row['median_ms']:,.0f} | {row['p95_ms']:,.0f} | "
                     f"{row['match_ms']:.0f} | {row['pose_ms']:.0f} | {row['other_ms']:,.0f} | "
                     f"{row['localized']} of {row['frames']} | {row['right_place']} | {row['right_pose']} | "
                     f"{row['strangers_localized']} of {row['strangers']} | {row['ready_s']:.1f} | {row['resident_bytes'] / 1e6:,.0f} | {row['database_bytes'] / 1e6:,.0f} |")
    return lines + ["", f"{machine}; seed {data['seed']}."]


# By name: the block of the page, what measures it, and its table.
TABLES = {
    "query": ("query", measure_query, query_table),
    "load": ("load", measure_load, load_table),
    "scale": ("many places", measure_scale("scale"), scale_table),
    "scale-small": ("many small places", measure_scale("scale-small"), scale_table),
}
