"""script/reliability tells results that are old or missing: a repository of its own, with results of known age."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SOAK = '''# Soak
<!-- written by script/soak -->
Commit {commit}, 2026-01-02 03:04 UTC, Some Processor, 2 cores, 3,600 s in all, seeds from 77. To its end.

| check | done | rounds | seconds | result |
|---|---|---|---|---|
| random machines | 12 machines | 2 | 653 | nothing found |
<!-- end -->
'''
MUTANTS = '| mutant | obligation | test | at |\n|---|---|---|---|\n| a | b | Slab.Finds | abc1234, 2026-01-02 |\n'


class Reliability(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix='carousel_reliability_')
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ('docs/internals/data', 'script', 'tests'):
            (self.root / name).mkdir(parents=True)
        shutil.copy(SOURCE / 'script/test', self.root / 'script/test')
        (self.root / 'docs/internals/mutants.md').write_text(MUTANTS)
        (self.root / 'tests/mutants.txt').write_text('a: b\nfile: x\n')
        self.git('init', '-q')
        self.commits(1)
        commit = self.git('rev-parse', '--short', 'HEAD').strip()
        (self.root / 'docs/internals/soak.md').write_text(SOAK.format(commit=commit))

    def git(self, *words):
        user = ('-c', 'user.name=a', '-c', 'user.email=a@b.invalid', '-c', 'commit.gpgsign=false')
        return subprocess.run(['git', '-C', self.root, *user, *words], capture_output=True, text=True, check=True).stdout

    def commits(self, count):
        for _ in range(count):
            self.git('commit', '-q', '--allow-empty', '-m', 'x')

    def page(self):
        return subprocess.run([sys.executable, SOURCE / 'script/reliability', '--print', '--root', self.root],
                              capture_output=True, text=True, check=True).stdout

    def test_a_soak_of_fifty_commits_is_young_and_of_fifty_one_is_old(self):
        self.commits(50)
        self.assertIn('It is 50 commits old. To its end.', self.page())
        self.assertNotIn('older than 50 commits', self.page())
        self.commits(1)
        self.assertIn('**It is older than 50 commits', self.page())

    def test_what_was_tried_stands_in_it(self):
        page = self.page()
        self.assertIn('on 2026-01-02', page)
        self.assertIn('for 1.0 hours (Some Processor, 2 cores), seeds from 77', page)
        self.assertIn('| random machines | 12 machines | nothing found |', page)
        self.assertIn('ThreadSanitizer on the engines', page)
        self.assertIn('**Not measured yet**', page)

    def test_faults_that_were_not_planted_are_told(self):
        self.assertNotIn('not been run yet', self.page())
        (self.root / 'tests/mutants.txt').write_text('a: b\nfile: x\n\nc: d\nfile: y\n')
        self.assertIn('**1 has not been run yet.**', self.page())

    def test_a_soak_that_was_never_run_is_told(self):
        (self.root / 'docs/internals/soak.md').write_text(SOAK.format(commit='0123456'))
        self.assertIn('**It is older than 50 commits', self.page())
        (self.root / 'docs/internals/soak.md').write_text('# Soak\n')
        self.assertIn('**No whole soak has been run.**', self.page())


if __name__ == '__main__':
    unittest.main()
