#!/usr/bin/env python3
"""`overfly reproduce` from outside, at tiny sizes: its tables as Markdown, JSON and CSV, what it leaves out, how it
refuses. Usage: test_reproduce.py OVERFLY [NAME]..."""
import csv
import json
import math
import os
import subprocess
import sys

from cli_support import DEM, Cli, expect, expect_true, run_cases

PAPERS = {"loeffler": ["table1", "table2"], "biedermann": ["table1"], "yalcin": ["table1"], "ye": ["results"]}
TINY = ["--quick", "--sides", "65,129", "--seconds", "0.2"]


class ReproduceCli(Cli):
    """Each paper's tiny experiment once, its three forms kept."""

    def __init__(self, program, folder):
        super().__init__(program, folder)
        self.results = {}

    def run(self, *arguments, **environment):
        return super().run("reproduce", *arguments, **environment)

    def output(self, *arguments):
        code, out, err = self.run(*arguments)
        expect(f"{' '.join(arguments)}: exit status, having said {err!r}", code, 0)
        return out

    def result(self, paper):
        """(folder, JSON) of the tiny experiment."""
        if paper not in self.results:
            folder = os.path.join(self.folder, paper)
            os.makedirs(folder, exist_ok=True)
            expect(f"{paper} -o: stdout", self.output(paper, *TINY, "-o", folder), "")
            with open(os.path.join(folder, f"{paper}.json"), encoding="utf-8") as file:
                self.results[paper] = (folder, json.load(file))
        return self.results[paper]


def cells_of(row):
    """A row of JSON as CSV names its columns."""
    cells = {name: value for name, value in row.items() if name not in ("paper", "ours")}
    for group in ("paper", "ours"):
        cells.update({f"{group}_{name}": value for name, value in row[group].items()})
    return cells


def markdown_tables(text):
    """The cells of each table, rows of texts, headers left out."""
    tables, inside = [], False
    for line in text.splitlines():
        if not line.startswith("|"):
            inside = False
            continue
        if not inside:
            tables.append([])
        inside = True
        tables[-1].append([cell.strip() for cell in line.strip("|").split("|")])
    return [table[2:] for table in tables]


def the_json_keeps_its_contract(cli):
    for paper, ids in PAPERS.items():
        report = cli.result(paper)[1]
        expect(f"{paper}: paper", report["paper"], paper)
        expect(f"{paper}: tables", [table["id"] for table in report["tables"]], ids)
        expect_true(f"{paper}: the paper's hardware", len(report["hardware"]["paper"]) > 10)
        machine = report["hardware"]["ours"]["machine"]
        expect_true(f"{paper}: our hardware: {machine}", machine["processor"] and machine["processors"] >= 1)
        expect_true(f"{paper}: set-up", len(report["set_up"]) >= 1)
        for table in report["tables"]:
            expect_true(f"{paper} {table['id']}: rows", len(table["rows"]) >= 2)
            for row in table["rows"]:
                expect_true(f"{paper} {table['id']}: {row}", row["paper"] and row["ours"] and "size" in row)
                expect_true(f"{paper}: a side in {row['size']}", row["size"] in (65, 129))


def quick_says_what_it_left_out(cli):
    for paper in PAPERS:
        report = cli.result(paper)[1]
        expect(f"{paper}: quick", report["quick"], True)
        expect_true(f"{paper}: left out: {report['left_out']}", any("drawing" in text for text in report["left_out"]))
        with open(os.path.join(cli.result(paper)[0], f"{paper}.md"), encoding="utf-8") as file:
            text = file.read()
        for note in report["left_out"]:
            expect_true(f"{paper}: 'Left out: {note}' in the text", f"Left out: {note}." in text)


def csv_and_json_agree(cli):
    for paper, ids in PAPERS.items():
        folder, report = cli.result(paper)
        for table in report["tables"]:
            with open(os.path.join(folder, f"{paper}_{table['id']}.csv"), newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            expect(f"{paper} {table['id']}: rows", len(rows), len(table["rows"]))
            for in_csv, in_json in zip(rows, table["rows"]):
                wanted = cells_of(in_json)
                expect(f"{paper}: columns", set(in_csv), set(wanted))
                for name, value in wanted.items():
                    found = in_csv[name]
                    same = found == "" if value is None else found == value if isinstance(value, str) else \
                        math.isclose(float(found), value, rel_tol=1e-12)
                    expect_true(f"{paper} {name}: CSV has {found!r}, JSON {value!r}", same)
        expect(f"{paper}: files", sorted(os.listdir(folder)),
               sorted([f"{paper}.md", f"{paper}.json"] + [f"{paper}_{name}.csv" for name in ids]))


def the_text_is_markdown_of_the_same_numbers(cli):
    for paper in PAPERS:
        folder, report = cli.result(paper)
        with open(os.path.join(folder, f"{paper}.md"), encoding="utf-8") as file:
            tables = markdown_tables(file.read())
        expect(f"{paper}: tables", len(tables), len(report["tables"]))
        for shown, table in zip(tables, report["tables"]):
            expect(f"{paper}: rows", len(shown), len(table["rows"]))
            with open(os.path.join(folder, f"{paper}_{table['id']}.csv"), encoding="utf-8") as file:
                names = file.readline().strip().split(",")
            # Columns without a figure in any row are not shown.
            order = [name for name in names if any(cells_of(row)[name] is not None for row in table["rows"])]
            for row, in_json in zip(shown, table["rows"]):
                values = cells_of(in_json)
                expect(f"{paper}: cells in {row}", len(row), len(order))
                for text, name in zip(row, order):
                    value = values[name]
                    decimals = len(text.split(".")[1]) if "." in text else 0
                    same = text == "-" if value is None else text == value if isinstance(value, str) else \
                        abs(float(text) - value) <= 0.5001 * 10.0 ** -decimals
                    expect_true(f"{paper} {name}: the text has {text!r}, JSON {value!r}", same)


def stdout_has_the_tables_or_the_json(cli):
    text = cli.output("ye", *TINY)
    expect_true(f"Markdown: {text[:80]!r}", text.startswith("## ") and len(markdown_tables(text)) == 1)
    expect("--json: paper", json.loads(cli.output("ye", *TINY, "--json"))["paper"], "ye")


def a_given_dem_is_flown_over(cli):
    report = json.loads(cli.output("ye", DEM, "--quick", "--sides", "65", "--seconds", "0.1", "--json"))
    expect("sides", {row["size"] for row in report["tables"][0]["rows"]}, {65})
    cli.refused(1, ["nowhere.tif"], "ye", "nowhere.tif", "--quick")


def figures_stand_in_the_rows_they_belong_to(cli):
    rows = cli.result("biedermann")[1]["tables"][0]["rows"]
    expect("vertices", {row["vertices"] for row in rows},
           {180000, 160000, 140000, 120000, 100000, 80000, 60000, 40000, 20000, 5000})
    best = [row["paper"]["increase_percent"] for row in rows if row["vertices"] == 120000]
    expect("the paper's best", set(best), {69.64})
    report = json.loads(cli.output("ye", "--quick", "--sides", "1025", "--seconds", "0.1", "--json"))
    rows = report["tables"][0]["rows"]
    found = {(row["method"], row["bound"]): row["paper"]["triangles"] for row in rows}
    expect("de Boer's triangles", found["geomipmap", "published"], 30000)
    expect("what the paper has not measured", found["geomipmap", "centre"], None)
    # Sizes that a paper has not measured have no figures of it.
    for paper in ("loeffler", "yalcin", "ye"):
        for table in cli.result(paper)[1]["tables"]:
            for row in table["rows"]:
                expect(f"{paper} {table['id']}: figures of side {row['size']}", set(row["paper"].values()), {None})


def cheaper_methods_draw_no_more(cli):
    """What must hold on any machine: numbers of triangles and errors, not times."""
    for row in cli.result("loeffler")[1]["tables"][1]["rows"]:
        expect_true(f"hybrid within patch: {row}", row["ours"]["hybrid_triangles"] <= row["ours"]["patch_triangles"])
    for row in cli.result("ye")[1]["tables"][0]["rows"]:
        if row["bound"] == "centre" or row["method"] == "hybrid":
            expect_true(f"the bound kept: {row}", row["ours"]["error_max_px"] <= row["ours"]["tau_px"] * (1 + 1e-6))
    for row in cli.result("biedermann")[1]["tables"][0]["rows"]:
        expect_true(f"surplus: {row}", -1e-9 <= row["ours"]["surplus_percent"] < 50)


def a_wrong_paper_is_told_the_four(cli):
    names = ["'loeffler'", "'biedermann'", "'yalcin'", "'ye'"]
    cli.refused(2, names + ["'lofler'"], "lofler")
    cli.refused(2, names)
    cli.refused(2, ["--sides", "'100'"], "ye", "--sides", "100")
    cli.refused(2, ["--seconds"], "ye", "--seconds", "0")


def bash_completes_the_papers(cli):
    source = os.path.join(os.path.dirname(DEM), "..", "bash-completion", "overfly")
    script = f"""source {source}; compopt() {{ :; }}
        offered() {{
            COMP_WORDS=({cli.program} "$1" "$2") COMP_CWORD=2 COMPREPLY=()
            _overfly
            echo "${{COMPREPLY[@]}}"
        }}
        offered reproduce ''; offered reproduce l; offered bench pre"""
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, cwd=cli.folder, check=False,
                          env=cli.environment)
    expect(f"completions, having said {done.stderr!r}", done.stdout.split("\n")[:3],
           ["loeffler biedermann yalcin ye", "loeffler", "preprocess"])


def folders_are_checked_before_the_work(cli):
    cli.refused(1, ["nowhere", "not a folder"], "ye", *TINY, "-o", "nowhere")
    cli.refused(1, ["/proc", "no file can be made in it"], "ye", *TINY, "-o", "/proc")


TESTS = [the_json_keeps_its_contract, quick_says_what_it_left_out, csv_and_json_agree,
         the_text_is_markdown_of_the_same_numbers, stdout_has_the_tables_or_the_json, a_given_dem_is_flown_over,
         figures_stand_in_the_rows_they_belong_to, cheaper_methods_draw_no_more, a_wrong_paper_is_told_the_four,
         bash_completes_the_papers, folders_are_checked_before_the_work]


if __name__ == "__main__":
    sys.exit(run_cases(TESTS, ReproduceCli))
