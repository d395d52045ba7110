"""Completion in bash and zsh, asked as the shells ask, and the manual page. CAROUSEL names the program."""

import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

CAROUSEL = os.environ["CAROUSEL"]

# Prints what bash would offer, a line for each question; readline replaces what stands behind the last = or :.
ASK_BASH = r"""
source "$1"
while IFS= read -r COMP_LINE; do
  COMP_POINT=${#COMP_LINE} COMPREPLY=()
  _carousel carousel
  echo "${COMPREPLY[*]}"
done
"""

# Offers are caught where zsh would add them; zpty gives zsh a terminal to complete on.
ASK_ZSH = r"""
zmodload zsh/zpty
fpath=($1 $fpath)
zpty ask zsh -f -i
zpty -w ask "PS1=; unsetopt zle_bracketed_paste; fpath=($1 \$fpath); autoload -Uz compinit; compinit -D -u"
zpty -w ask 'compadd() { local -a given=("$@"); while [[ ${1-} == -* ]]; do [[ $1 == -- ]] && { shift; break; };
  [[ $1 == -(P|S|p|s|i|I|W|d|J|X|x|V|r|R|D|O|A|E|M|F) ]] && shift; shift; done; print -r -- "<$*>" >>'$2'; builtin compadd "${given[@]}" }'
for line in "${(@f)3}"; do
  zpty -w ask "print -r -- '? $line' >>$2"
  for i in {1..300}; do [[ "$(tail -n 1 $2 2>/dev/null)" == "? $line" ]] && break; sleep 0.1; done
  zpty -w -n ask "$line"$'\t'
  for i in {1..300}; do [[ "$(tail -n 1 $2)" != "? $line" ]] && break; sleep 0.1; done
  sleep 0.5
  zpty -w -n ask $'\x15'
done
sleep 0.2
zpty -d ask
"""


def written(*arguments):
    done = subprocess.run([CAROUSEL, *arguments], capture_output=True, text=True, check=True)
    return done.stdout


def keys_of(schema, path=""):
    """Paths of the keys of a JSON Schema that are not sections, with their enumerations."""
    for name, value in schema.get("properties", {}).items():
        inner = path + name
        if "properties" in value:
            yield from keys_of(value, inner + ".")
        else:
            yield inner, value.get("enum", [])


class Usage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.keys = dict(keys_of(json.loads(written("schema", "config"))))
        cls.help = {name: written(name, "--help") for name in cls.commands()}

    @staticmethod
    def commands():
        listed = written("--help").split("Subcommands:")[1].split("\n\n")[0]
        return re.findall(r"^  ([a-z]+) ", listed, re.M)

    def ask_bash(self, *lines):
        with tempfile.NamedTemporaryFile("w", suffix=".bash") as script:
            script.write(written("completion", "bash"))
            script.flush()
            done = subprocess.run(["bash", "-c", ASK_BASH, "ask", script.name], input="".join(l + "\n" for l in lines),
                                  capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        return [line.split() for line in done.stdout.split("\n")[:-1]]

    def test_bash_offers_commands_options_keys_and_values(self):
        asked = {
            "carousel ": {"run", "sweep", "completion", "man", "--help"},
            "carousel sw": {"sweep"},
            "carousel run --tr": {"--trace", "--trace-window", "--trace-sample", "--trace-events"},
            "carousel run a.yaml --set topology.sh": {"topology.shape="},
            "carousel run a.yaml --set topology.shape=bi": {"bidirectional"},
            "carousel run a.yaml --set=topology.shape=bi": {"bidirectional"},
            "carousel run --set=topology.sh": {"topology.shape="},
            "carousel check a.yaml --set bundles.split=": set(self.keys["bundles.split"]),
            "carousel run a.yaml --set engine.threads=a": {"auto"},
            "carousel run a.yaml --log-level in": {"info"},
            "carousel sweep a.yaml --vary collections.policy=nearest,f": {"collections.policy=nearest,fullest"},
            "carousel sweep a.yaml --scene builtin:co": {"cornell"},
            "carousel sweep a.yaml --scene bui": {f"builtin:{n}" for n in self.keys["scene.builtin"]},
            "carousel stress --queue mutex,sp": {"mutex,spsc_ring"},
            "carousel stress --pattern ping": {"ping_pong"},
            "carousel schema ": {"config", "report"},
            "carousel completion z": {"zsh"},
            "carousel run --no-such": set(),
            "carousel run conf": set(),  # bash offers files itself
        }
        for (line, expected), offered in zip(asked.items(), self.ask_bash(*asked)):
            offered = {word.replace("collections.policy=", "") for word in offered}
            expected = {word.replace("collections.policy=", "") for word in expected}
            if line == "carousel ":
                self.assertLessEqual(expected, offered)
            else:
                self.assertEqual(offered, expected, line)

    def test_bash_knows_every_option_and_every_key(self):
        lines = [f"carousel {name} -" for name in self.help]
        for name, offered in zip(self.help, self.ask_bash(*lines)):
            listed = set(re.findall(r"^  (?:-h,)?(--[a-z-]+)", self.help[name], re.M))
            self.assertLessEqual(listed, set(offered), name)
        offered, = self.ask_bash("carousel run --set ")
        self.assertLessEqual({key + "=" for key in self.keys if key != "vary"}, set(offered))
        lines = {key: f"carousel run --set {key}=" for key, words in self.keys.items() if words}
        for key, offered in zip(lines, self.ask_bash(*lines.values())):
            self.assertEqual(offered, self.keys[key], key)

    def test_zsh_offers_the_same(self):
        if shutil.which("zsh") is None:
            self.skipTest("zsh is not installed")
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "_carousel").write_text(written("completion", "zsh"))
            subprocess.run(["zsh", "-n", f"{folder}/_carousel"], check=True)
            log = Path(folder) / "offered"
            lines = ["carousel sw", "carousel run --tra", "carousel run a.yaml --set topology.sh",
                     "carousel run a.yaml --set topology.shape=bi"]
            subprocess.run(["zsh", "-f", "-c", ASK_ZSH, "ask", folder, str(log), "\n".join(lines)], check=True,
                           capture_output=True, timeout=240)
            answers = dict(part.split("\n", 1) for part in log.read_text().split("? ")[1:])
        for line, word in zip(lines, ["sweep", "--trace", "topology.shape", "bidirectional"]):
            self.assertIn(word, answers[line], line)

    def test_the_manual_names_every_command_option_and_key(self):
        page = written("man")
        with tempfile.NamedTemporaryFile("w", suffix=".1") as file:
            file.write(page)
            file.flush()
            done = subprocess.run(["man", "--warnings", "-l", file.name], capture_output=True, text=True,
                                  env={**os.environ, "MANWIDTH": "100", "LC_ALL": "C.UTF-8"}, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        shown = re.sub(".\b", "", done.stdout)
        for name, text in self.help.items():
            self.assertIn(f"carousel {name}\n", shown)
            for option in re.findall(r"^  (?:-h,)?(--[a-z-]+)", text, re.M):
                self.assertIn(option, shown, name)
        for key in self.keys:
            self.assertIn(key, shown)

    def test_help_teaches(self):
        top = written("--help")
        for text in ("First steps:", "carousel run configs/demo.yaml", "docs/guides/tutorial.md", "man"):
            self.assertIn(text, top)
        for name, text in self.help.items():
            self.assertRegex(text, rf"Examples:\n  .*carousel {name}", name)


if __name__ == "__main__":
    unittest.main()
