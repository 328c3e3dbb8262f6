"""The scripts that guard the repository find what they are for, and pass what is right."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
JUNIT = """<testsuite>
<testcase name="a" status="run"/>
<testcase name="b" status="fail"><failure message=""/></testcase>
<testcase name="c" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>
<testcase name="d" status="notrun"><skipped message="Unable to find executable"/></testcase>
<testcase name="e" status="disabled"/>
</testsuite>"""


def run_on(files, script, argument="."):
    """Exit status and output of one of our scripts in a folder that holds `files` (path -> text)."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        command = [sys.executable, str(ROOT / "scripts" / script), argument]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


class CheckLayers(unittest.TestCase):
    def check(self, path, include):
        files = {"engine/cloud/normals.hpp": "", "store/store.hpp": "", path: include}
        return run_on(files, "check_layers.py")

    def test_passes_what_the_table_allows(self):
        self.assertEqual((0, ""), self.check("engine/features/shot.hpp", '#include "engine/cloud/normals.hpp"\n'))
        self.assertEqual((0, ""), self.check("store/blob.cpp", "#include <sqlite3.h>\n"))
        self.assertEqual((0, ""), self.check("engine/features/shot.cpp", "#include <pcl/features/shot.h>\n"))

    def test_names_the_line_that_looks_up(self):
        status, output = self.check("engine/types/x.hpp", '\n#include "engine/cloud/normals.hpp"\n')
        self.assertEqual(1, status)
        self.assertIn('engine/types/x.hpp:2: engine/types may not include "engine/cloud/normals.hpp"', output)

    def test_refuses_sql_in_the_engine_and_the_store_in_the_client(self):
        self.assertEqual(1, self.check("engine/cloud/x.cpp", "#include <sqlite3.h>\n")[0])
        self.assertEqual(1, self.check("client/x.cpp", '#include "store/store.hpp"\n')[0])

    def test_refuses_pcl_in_a_header_and_the_parts_that_bring_vtk(self):
        self.assertEqual(1, self.check("engine/features/x.hpp", "#include <pcl/point_types.h>\n")[0])
        self.assertEqual(1, self.check("engine/features/x.cpp", "#include <pcl/io/pcd_io.h>\n")[0])

    def test_refuses_a_path_that_does_not_start_at_the_root(self):
        self.assertEqual(1, self.check("engine/cloud/x.cpp", '#include "normals.hpp"\n')[0])


class CheckTestsListed(unittest.TestCase):
    def test_names_a_test_that_no_target_has(self):
        files = {"tests/unit/CMakeLists.txt": "landmarkdb_test(a LABEL unit SOURCES a_test.cpp)\n# b_test.cpp\n"}
        files |= {"tests/unit/a_test.cpp": "", "tests/unit/b_test.cpp": ""}
        status, output = run_on(files, "check_tests_listed.py")
        self.assertEqual((1, "tests/unit/b_test.cpp: in no landmarkdb_test(...)\n"), (status, output))

    def test_passes_when_all_are_listed(self):
        files = {"tests/CMakeLists.txt": "landmarkdb_test(a LABEL unit\n  SOURCES unit/a_test.cpp)\n"}
        files |= {"tests/unit/a_test.cpp": ""}
        self.assertEqual(0, run_on(files, "check_tests_listed.py")[0])


class CheckTypes(unittest.TestCase):
    def check(self, first, second):
        return run_on({"engine/a.hpp": first, "server/b.cpp": second}, "check_types.py")

    def test_names_the_second_of_two_types_of_one_name(self):
        a = "namespace landmarkdb {\n// struct Not {\ntemplate <class T> struct Marker { int x; };\n}\n"
        b = "namespace landmarkdb {\nclass Other;\nclass Marker final : public Base {\n};\n}\n"
        message = "server/b.cpp:3: landmarkdb::Marker is also defined at engine/a.hpp:3\n"
        self.assertEqual((1, message), self.check(a, b))
        self.assertEqual(1, self.check("namespace a {\nnamespace b { enum class E : int { x }; } }", "namespace a::b { union E { }; }")[0])

    def test_passes_types_that_are_apart(self):
        a = "namespace landmarkdb { struct Marker { char c = '{'; }; }"
        for b in (
            "namespace landmarkdb { namespace { struct Marker { }; } }",
            "namespace landmarkdb::bench { struct Marker { }; }",
            "namespace landmarkdb { struct Marker; struct Use { struct Marker { }; }; }",
            "namespace landmarkdb { void f() { struct Marker { }; } }",
            "namespace landmarkdb { Marker make() { return {}; } Marker all[] = {{}}; }",
            '// namespace landmarkdb { struct Marker { }; }\nauto text = R"(namespace landmarkdb { struct Marker { }; })";',
        ):
            self.assertEqual((0, ""), self.check(a, b), b)


class SummariseTests(unittest.TestCase):
    def test_counts_what_ran_and_names_what_failed(self):
        status, output = run_on({"x.xml": JUNIT}, "summarise_tests.py", "x.xml")
        self.assertEqual(1, status)
        self.assertEqual(
            ["failed: b", "failed: d (Unable to find executable)", "1 passed, 2 failed, 2 skipped"],
            output.splitlines(),
        )

    def test_fails_when_no_test_ran(self):
        self.assertEqual((1, "0 passed, 0 failed\n"), run_on({"x.xml": "<t/>"}, "summarise_tests.py", "x.xml"))

    def test_fails_without_results(self):
        self.assertEqual(1, run_on({}, "summarise_tests.py", "x.xml")[0])


if __name__ == "__main__":
    unittest.main()
