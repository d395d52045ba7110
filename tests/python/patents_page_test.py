"""Every key, value and test that docs/patents.md names exists, and what it calls not built is refused by name."""

import json
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMED = re.compile(r'`([^`]+)`')
KEY = re.compile(r'^[a-z_]+(\.[a-z_]+)*$')
TEST = re.compile(r'^[A-Z][A-Za-z0-9]*\.([A-Z][A-Za-z0-9]*|\*)$')


def rows():
    """Cells of each row of the page's tables: feature, keys, shown by."""
    for line in (ROOT / 'docs/patents.md').read_text().splitlines():
        cells = [cell.strip() for cell in line.strip('|').split('|')]
        if line.startswith('|') and cells[0] != 'feature' and not cells[0].startswith('---'):
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

    def test_keys_and_values_exist(self):
        known = 0
        for _, keys, _ in rows():
            last = None
            for named in NAMED.findall(keys):
                key, _, value = named.partition(': ')
                if '.' not in key and last is not None and not value and at(self.schema, key) is None:
                    key, value = last, key       # a further value of the key before
                self.assertRegex(key, KEY)
                found = at(self.schema, key)
                self.assertIsNotNone(found, f'there is no key {key}')
                if value:
                    self.assertIn(f'"{value}"', json.dumps(found), f'{key} has no value {value}')
                last, known = key, known + 1
        self.assertGreater(known, 100)

    def test_tests_exist(self):
        existing, known = tests(), 0
        for _, _, shown in rows():
            for named in NAMED.findall(shown):
                if TEST.match(named):
                    self.assertIn(named, existing)
                    known += 1
        self.assertGreater(known, 90)

    def test_what_is_not_built_is_refused(self):
        refused = (ROOT / 'core/config/not_built.cpp').read_text()
        missing = {NAMED.findall(keys)[0] for _, keys, shown in rows() if shown.startswith('not built')}
        both = {f'{key}: {value}' for key, value in re.findall(r'\{"([\w.]+)", "(\w+)", kBoth\}', refused)}
        self.assertEqual(missing, both)


if __name__ == '__main__':
    unittest.main()
