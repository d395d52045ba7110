"""Every key, value, test and file that docs/studies/patents.md names exists, and its sum is that of its rows."""

import json
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMED = re.compile(r'`([^`]+)`')
KEY = re.compile(r'^([a-z_]+(?:\.[a-z0-9_]+)*)(?:: ([a-z_]+))?$')
TEST = re.compile(r'^[A-Z]\w*\.([A-Z]\w*|\*)$')
ANSWERS = re.compile(r'^((yes|narrowly)(, cycle|, native)?|no)$')


def rows():
    """Cells of each row of the page's tables: number, feature, works, shown by, missing."""
    for line in (ROOT / 'docs/studies/patents.md').read_text().splitlines():
        cells = [cell.strip() for cell in line.split('|')[1:-1]]
        if cells and cells[0].isdigit():
            yield cells


def tests():
    found = set()
    for source in (ROOT / 'tests').rglob('*.cpp'):
        for suite, name in re.findall(r'\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)', source.read_text()):
            found |= {f'{suite}.{name}', f'{suite}.*'}
    return found


def at(schema, path):
    """The schema of a key, or None."""
    root = schema
    for name in path.split('.'):
        while '$ref' in schema:
            schema = at_pointer(root, schema['$ref'])
        found = [part['properties'][name] for part in [schema, *schema.get('anyOf', []), *schema.get('allOf', [])]
                 if name in part.get('properties', {})]
        if not found:
            return None
        schema = found[0]
    return schema


def at_pointer(root, pointer):
    for name in pointer.lstrip('#/').split('/'):
        root = root[name]
    return root


class PatentsPage(unittest.TestCase):
    def setUp(self):
        self.schema = json.loads((ROOT / 'configs/schema.json').read_text())

    def test_every_feature_has_an_answer(self):
        table = list(rows())
        self.assertEqual([int(row[0]) for row in table], list(range(1, len(table) + 1)))
        count = {'yes': 0, 'narrowly': 0, 'no': 0}
        for number, _, works, shown, missing in table:
            self.assertRegex(works, ANSWERS, number)
            self.assertTrue(missing or works.startswith('yes'), f'{number} does not say what is narrowed or missing')
            self.assertEqual(shown == '', works == 'no', f'{number}: a feature is shown by something, or is not built')
            count[works.split(',')[0]] += 1
        page = (ROOT / 'docs/studies/patents.md').read_text()
        summed = f'{count["yes"]} work, {count["narrowly"]} work narrowly and {count["no"]} do not'
        self.assertIn(f'Of {len(table)} features {summed}.', page)
        self.assertIn(f'Of {len(table)} features of the patents {summed}', (ROOT / 'README.md').read_text())

    def test_each_row_is_shown_by_runs_or_says_why_not(self):
        works = {int(row[0]): row[2] for row in rows()}
        lines = [[cell.strip() for cell in line.split('|')] for line in (ROOT / 'tests/patents.txt').read_text().splitlines()
                 if line[:1].isdigit()]
        self.assertEqual({int(cells[0]) for cells in lines}, set(works))
        moved = {int(cells[0]) for cells in lines if len(cells) > 5 and cells[5] != 'refused'}
        without = {int(cells[0]) for cells in lines if cells[1] == 'no run'}
        self.assertFalse(moved & without)
        for cells in lines:
            row = int(cells[0])
            if row in without:
                self.assertEqual(len(cells), 3, cells)
                continue
            self.assertIn(len(cells), (6, 7), cells)
            refused = cells[5] == 'refused'
            # What is refused is a feature that is missing, or the restriction of one that works.
            if works[row] == 'no':
                self.assertTrue(refused, f'{row} moves a number and is said not to work')
            else:
                self.assertIn(row, moved, f'{row} works, and no line moves a number')
            for setting in ' '.join(cells[1:3 if refused else 4]).split():
                if setting.startswith('@'):
                    name, _, value = setting[1:].partition('=')
                    self.assertIn(name, ('config', 'ranks', 'level', 'spawn'), cells)
                    self.assertTrue(name != 'config' or (ROOT / value).is_file(), value)
                else:
                    self.assertIsNotNone(at(self.schema, setting.partition('=')[0]), setting)

    def test_keys_and_values_exist(self):
        report, known = ''.join(page.read_text() for page in (ROOT / 'docs/reference/report').glob('*.md')), 0
        for number, _, _, shown, missing in rows():
            last = None
            for named in NAMED.findall(shown + missing):
                if not KEY.match(named) or (ROOT / named).exists():
                    continue
                key, value = KEY.match(named).groups()
                if at(self.schema, key) is None and '.' not in key and last is not None:
                    key, value = last, key       # a further value of the key before
                found = at(self.schema, key)
                if found is None:
                    self.assertTrue(f'`{key}`' in report, f'{number}: there is no key {key}')
                if value:
                    self.assertIn(f'"{value}"', json.dumps(found), f'{number}: {key} has no value {value}')
                last, known = key, known + 1
        self.assertGreater(known, 100)

    def test_tests_and_files_exist(self):
        existing, known = tests(), 0
        page = (ROOT / 'docs/studies/patents.md').read_text()
        for named in NAMED.findall(page):
            if TEST.match(named):
                self.assertIn(named, existing)
                known += 1
        self.assertGreater(known, 120)
        for name in re.findall(r'\]\(([^)#]+)', page) + re.findall(r'\b(configs/\w+\.yaml)', page):
            self.assertTrue((ROOT / 'docs/studies' / name).exists() or (ROOT / name).exists(), f'there is no {name}')


if __name__ == '__main__':
    unittest.main()
