"""The checks of script/check-tree on classes and on the whole Config find what is planted."""

import importlib.machinery
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def load_check_tree():
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("check_tree", str(SOURCE / "script/check-tree"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_tree", loader))
    loader.exec_module(module)
    return module


check_tree = load_check_tree()

# Everything that may be a member or a method, and what looks like one. In the order of the comments: 1, 2, ...
EVERYTHING = """
namespace carousel { namespace {
inline int free_function(int a) { return a; }
template <class T>
class [[nodiscard]] Everything final : public Base<T> {
 public:
  explicit Everything(int a, int b = 2) : a_(a) { int local = b; }  // method 1
  Everything(const Everything&) = delete;
  ~Everything() override;                                           // method 2
  Everything& operator=(Everything&&) noexcept = default;           // method 3
  bool operator()(int) const;                                       // method 4
  bool operator<(const Everything&) const { return false; }         // method 5
  int overloaded(int) const { return 1; }                           // method 6
  int overloaded(std::vector<std::pair<int, T>>) { return 1; }      // method 7
  template <class U>
  void made(U&& u) requires std::is_class_v<U> { u(); }             // method 8
  static int counted() { return 0; }                                // method 9
  operator bool() const;                                            // method 10
  friend bool operator==(const Everything&, const Everything&) = default;
  friend auto operator<=>(const Everything& x, const Everything& y) { return x.a_ <=> y.a_; }
  enum class Kind { kOne, kTwo };
  struct Inner {
    int one = 1, two = 2;
    int three() const { return 3; }
    friend auto operator<=>(const Inner& x, const Inner& y) { return x.one <=> y.one; }
  };
  using Alias = int;

 private:
  static constexpr int kConstant = 3;
  int a_, b_ = 2, c_{3};                                            // members 1 to 3
  std::function<void(int)> call_;                                   // member 4
  std::array<T, std::size_t(Kind::kTwo)> array_{};                  // member 5
  alignas(64) std::atomic<int> one_{0}, two_{0};                    // members 6 and 7
  Time end_ = ~Time{0}, next_ = 1;                                  // members 8 and 9
  std::map<int, std::vector<Inner>> map_;                           // member 10
  mutable const Inner *first_ = nullptr, &second_;                  // members 11 and 12
  struct Depth {
    int first = 0;
  } depth_{};                                                       // member 13
};
}}  // namespace
"""


def class_of(members, methods, name="Large", private=True, constant=False):
    lines = [f"  void f{i}(){' const' if constant else ''};" for i in range(methods)]
    lines += [" private:"] if private else []
    lines += [f"  int m{i} = 0;" for i in range(members)]
    return f"namespace carousel::ringbus {{\nclass {name} {{\n public:\n" + "\n".join(lines) + "\n};\n}\n"


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="carousel_tree_")
        self.addCleanup(folder.cleanup)
        os.chdir(folder.name)
        self.addCleanup(os.chdir, SOURCE)

    def write(self, name, text):
        pathlib.Path(name).parent.mkdir(parents=True, exist_ok=True)
        pathlib.Path(name).write_text(text, encoding="utf-8")


class Order(InAFolder):
    ORDER = ("low:\n  low/base   what all use\n  low/parts   a file of each part\n  low/list   names them\n"
             "high: low\n  high/parts   what parts share\n  high/parts/*   a part\n")

    def faults(self, **more):
        files = {"low/base/a.h": "", "high/parts/b.h": "", "low/parts/one.h": '#include "low/base/a.h"\n',
                 "low/list/list.h": '#include "low/parts/one.h"\n',
                 "high/parts/one/agent.h": '#include "low/parts/one.h"\n#include "high/parts/b.h"\n'}
        files.update({name.replace("__", "/").replace("_h", ".h"): text for name, text in more.items()})
        self.write("folders.txt", self.ORDER)
        for name, text in files.items():
            self.write(name, text)
        place, allowed = check_tree.read_order()
        sources = sorted(files)
        return [*check_tree.include_faults(place, allowed, sources), *check_tree.size_faults(place, sources)]

    def test_includes_go_one_way(self):
        self.assertEqual(self.faults(), [])
        self.assertEqual(self.faults(low__parts__two_h='#include "low/list/list.h"\n'),
                         ["low/parts/two.h:1: low/parts stands above low/list in folders.txt and includes low/list/list.h"])
        self.assertEqual(self.faults(low__list__more_h='#include "high/parts/one/agent.h"\n'),
                         ["low/list/more.h:1: low may not include from high (high/parts/one/agent.h)"])
        self.assertEqual(self.faults(high__parts__one__deep__c_h=""),
                         ["high/parts/one/deep/c.h: folders.txt does not list high/parts/one/deep"])


class Classes(InAFolder):
    def sizes(self, text):
        self.write("a/a.h", text)
        return {one.name: (len(one.members), len(one.methods)) for one in check_tree.measure_classes(["a/a.h"])}

    def faults(self, text, listed="# none\n"):
        self.write("a/a.h", text)
        self.write("large.txt", listed)
        return list(check_tree.class_faults(check_tree.measure_classes(["a/a.h"]), "large.txt"))

    def test_members_and_methods_are_counted(self):
        sizes = self.sizes(EVERYTHING)
        self.assertEqual(sizes["Everything"], (13, 10))
        self.assertEqual(sizes["Everything::Inner"], (2, 1))
        self.assertEqual(sizes["Everything::Depth"], (1, 0))

    def test_definitions_outside_of_the_class_count_once(self):
        text = class_of(0, 3) + "".join(f"void carousel::ringbus::Large::f{i}() {{}}\n" for i in range(3))
        self.assertEqual(self.sizes(text)["ringbus::Large"], (0, 3))

    def test_limits(self):
        self.assertEqual(self.faults(class_of(30, 45)), [])
        self.assertEqual(self.faults(class_of(31, 1)), ["a/a.h:2: ringbus::Large has 31 data members; at most 30"])
        self.assertEqual(self.faults(class_of(0, 46)), ["a/a.h:2: ringbus::Large has 46 methods; at most 45"])

    def test_records_may_have_any_number_of_members(self):
        self.assertEqual(self.faults(class_of(60, 0, private=False)), [])
        self.assertEqual(self.faults(class_of(60, 2, private=False, constant=True)), [])
        for large in (class_of(60, 0), class_of(60, 1, private=False), class_of(60, 46, private=False, constant=True)):
            self.assertEqual(len(self.faults(large)), 1, large)

    def test_exceptions_may_only_shrink(self):
        row = "ringbus::Large 33 50 it is being divided\n"
        self.assertEqual(self.faults(class_of(33, 50), row), [])
        self.assertEqual(self.faults(class_of(31, 40), row), [])
        self.assertEqual(self.faults(class_of(34, 51), row),
                         ["a/a.h:2: ringbus::Large has 34 data members; at most 33",
                          "a/a.h:2: ringbus::Large has 51 methods; at most 50"])
        self.assertEqual(self.faults(class_of(30, 45), row),
                         ["large.txt:1: ringbus::Large is within the limits; remove the row"])
        self.assertEqual(self.faults(class_of(1, 1, "Other"), row),
                         ["large.txt:1: there is no class ringbus::Large; remove the row"])
        self.assertEqual(self.faults(class_of(1, 1), "ringbus::Large 33 50\n"),
                         ["large.txt:1: expected a class, its data members, its methods and a reason"])


class ConfigUsers(InAFolder):
    def test_the_list_may_only_shrink(self):
        self.write("a/a.cpp", '#include "a/a.h"\n\n#include "core/config/config.h"\n')
        self.write("a/b.cpp", '#include "core/config/fields/memory.h"\n// #include "core/config/config.h"\n')
        sources = ["a/a.cpp", "a/b.cpp"]
        self.write("users.txt", "# a comment\na/a.cpp\n")
        self.assertEqual(list(check_tree.config_faults(sources, "users.txt")), [])
        self.write("users.txt", "a/b.cpp\n")
        self.assertEqual(list(check_tree.config_faults(sources, "users.txt")),
                         ["a/a.cpp:3: takes the whole Config: take the section of your part",
                          "users.txt:1: a/b.cpp does not include core/config/config.h; remove the row"])


class Names(InAFolder):
    def faults(self, text):
        self.write("a/queue.h", "#pragma once\n\ntemplate <class T>\nclass Queue final : public Base {\n};\nenum class Side { kLeft };\n"
                                "using Depth = int;\n")
        self.write("a/user.h", text)
        return list(check_tree.name_faults(["a/queue.h", "a/user.h"]))

    def test_a_header_includes_what_it_names(self):
        for use, name in ("void f(const Queue<int>& queue);", "Queue"), ("Side side_of(int);", "Side"), ("Depth depth;", "Depth"):
            self.assertEqual(self.faults(use), [f"a/user.h: names {name} and does not include a/queue.h"])
            self.assertEqual(self.faults('#include "a/queue.h"\n' + use), [])

    def test_other_names_that_look_alike(self):
        for text in ("class Queue;\nvoid f(Queue&);", "struct Outer {\n  struct Side {};\n  Side side;\n};",
                     "// as Queue has it", "template <class Depth>\nvoid f(Depth);", "auto f() { return other::Side(); }"):
            self.assertEqual(self.faults(text), [], text)


class WholeTree(unittest.TestCase):
    def test_a_planted_class_and_a_planted_include_fail(self):
        """In a copy of the tree with its sources, and with two faults more."""
        with tempfile.TemporaryDirectory(prefix="carousel_tree_") as folder:
            listed = subprocess.check_output(["git", "-C", SOURCE, "ls-files", "-co", "--exclude-standard"], text=True)
            for path in listed.splitlines():
                if (path.endswith((".h", ".cpp", ".txt")) or path.startswith("script/")) and (SOURCE / path).is_file():
                    target = pathlib.Path(folder, path)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(SOURCE / path, target)
            subprocess.run(["git", "init", "-q", folder], check=True)
            pathlib.Path(folder, "core/text/planted.h").write_text("#pragma once\n" + class_of(31, 1), encoding="utf-8")
            pathlib.Path(folder, "core/config/planted.h").write_text(
                '#pragma once\n\n#include "core/config/config.h"\n', encoding="utf-8")
            done = subprocess.run([pathlib.Path(folder, "script/check-tree")], text=True, capture_output=True, check=False)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertIn("core/text/planted.h:3: ringbus::Large has 31 data members; at most 30", done.stdout)
            self.assertIn("core/config/planted.h:3: takes the whole Config", done.stdout)


if __name__ == "__main__":
    unittest.main()
