"""docs/reference/config: a page for each section of the configuration, each key with an example that the program accepts."""
import concurrent.futures
import json
import os
import re
import subprocess
import tempfile

import key_examples
from page_text import FILES, printed, sections, snippet, table_rows


def values(schema):
    """Values of a key that are no default, likely ones first."""
    if "anyOf" in schema:
        return [value for one in schema["anyOf"] for value in values(one) if value != schema.get("default")]
    if "const" in schema:
        return []
    if "enum" in schema:
        return [value for value in schema["enum"]
                if value != schema.get("default") and schema.get("engines", {}).get(value, ["all"])]
    if schema.get("type") == "boolean":
        return ["false" if schema.get("default") else "true"]
    if schema.get("type") in ("integer", "number"):
        whole = schema["type"] == "integer"
        low, high = schema.get("minimum", schema.get("exclusiveMinimum")), schema["maximum"]
        default = schema.get("default", low)
        default = default if isinstance(default, (int, float)) else low
        tried = [default * 2, default / 2, 1, 2, 4, 0.5] if default else [4, 2, 16, 1, 0.5, 0.1]
        kept = []
        for value in tried:
            if whole and value != int(value):
                continue
            value = int(value) if whole else round(value, 6)
            if low <= value <= high and value != schema.get("default") and not (value == low and "exclusiveMinimum" in schema):
                kept.append(f"{value:g}" if isinstance(value, float) else str(value))
        return list(dict.fromkeys(kept))
    return []


def key_schemas(schema):
    """Every key with its schema, as `carousel schema config --markdown` names keys."""
    found = {}

    def walk(path, at):
        if path:
            found[path] = at
        for name, below in at.get("properties", {}).items():
            walk(f"{path}.{name}" if path else name, below)
        if isinstance(at.get("additionalProperties"), dict):
            walk(f"{path}.NAME", at["additionalProperties"])
        if "properties" in at.get("items", {}):
            walk(f"{path}.0", at["items"])
        for one in at.get("anyOf", []):
            if "properties" in one:
                walk(path, {**one, "anyOf": []})
    walk("", schema)
    return found


def trials(key, schema):
    """Configurations that may show a key, the one to be preferred first."""
    begin = max((name for name in key_examples.UNDER if key.startswith(name)), key=len, default=None)
    settings = key_examples.KEYS.get(key, key_examples.UNDER.get(begin, []))
    last = key.rsplit(".", 1)[-1]
    for kind in ("cycle", "native"):
        base = list(settings)
        if not any(one.startswith(("scene.file", "scene.builtin", "workload")) for one in base) and not key.startswith(
                ("scene.file", "scene.builtin", "workload")):
            base.insert(0, "scene.builtin=cornell")
        if kind == "cycle" and not any(one.startswith("engine.kind=") for one in base) and key != "engine.kind":
            base.insert(1 if base and base[0].startswith("scene") else 0, "engine.kind=cycle")
        if any("KEY: VALUE" in one for one in base):
            for value in values(schema):
                yield [one.replace("KEY: VALUE", f"{last}: {value}") for one in base]
        elif any(one.startswith((f"{key}=", f"{key}.")) for one in settings) and key in key_examples.KEYS or (
                ".0." in key or "NAME" in key):
            yield base
        else:
            kept = [one for one in base if not one.startswith(key + "=")]
            for value in values(schema):
                yield kept + [f"{key}={value}"]


def refusal(program, text, folder):
    """Why the program does not accept a configuration; empty if it does."""
    with tempfile.NamedTemporaryFile("w", dir=folder, suffix=".yaml") as file:
        file.write(text)
        file.flush()
        done = subprocess.run([program, "check", os.path.basename(file.name), "--strict"], capture_output=True, text=True,
                              check=False, cwd=folder)
    return "" if done.returncode == 0 else (done.stderr.strip() or done.stdout.strip() or f"exit status {done.returncode}")


def key_example(program, key, schema, folder):
    """The first configuration that is accepted, and else none with the first refusal."""
    first = ""
    for settings in trials(key, schema):
        text = snippet(settings)
        why = refusal(program, text, folder)
        if not why:
            return text, ""
        first = first or f"{text}{why}"
    return None, first or "no row sets it, and it has no range to take a value from"


def anchor_of(key):
    return re.sub(r"[^\w\- ]", "", key.lower())


def config_pages(program, folder, missing):
    head, parts = sections(printed(program, "schema", "config", "--markdown"))
    schemas = key_schemas(json.loads(printed(program, "schema", "config")))
    keys = [row[0].strip("`") for _, text in parts for row in table_rows(text)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        examples = dict(zip(keys, pool.map(lambda key: key_example(program, key, schemas[key], folder), keys)))
    title, _, rest = head.partition("\n\n")
    rest = rest.replace("`carousel schema config --markdown`", "`script/docs --write`, from what `carousel schema config --markdown` prints")
    index = [title, "", rest.strip(), "", f"Each example is a whole file, which `carousel check --strict` accepts: the key has an effect there. {FILES}", "",
             "| section | keys | what it has |", "|---|---|---|"]
    pages = {}
    for name, text in parts:
        rows = list(table_rows(text))
        about = text.strip().split("\n", 1)[0]
        about = "" if about.startswith("|") else about
        index.append(f"| [`{name}`]({name}.md) | {len(rows)} | {about or rows[0][4]} |")
        page = [f"# {name}", "", *([about, ""] if about else []), "| key | values | default | unit |", "|---|---|---|---|"]
        page += [f"| [{key}](#{anchor_of(key.strip('`'))}) | {values} | {default} | {unit} |" for key, values, default, unit, _ in rows]
        for key, _, _, _, meaning in rows:
            example, why = examples[key.strip("`")]
            if example is None:
                plain = key.strip("`")
                missing.append(f'web/docs/key_examples.py: add to KEYS the settings with which {plain} has an effect, such as\n'
                               f'    "{plain}": ["other.key=VALUE"],\nor to UNDER those for all keys that begin alike. Tried:\n{why}')
            page += ["", f"## {key}", "", meaning, "", "```yaml", (example or "").rstrip(), "```"]
        pages[f"config/{name}.md"] = "\n".join(page) + "\n"
    return {"config/index.md": "\n".join(index) + "\n", **pages}
