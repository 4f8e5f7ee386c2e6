#!/usr/bin/env python3
"""Makes regrasp/methods.py from the method table: what `describe` answers is read from standard input.

    regrasp --json call describe | python3 make_methods.py > regrasp/methods.py
"""

import json
import keyword
import sys
import textwrap

TYPES = {"integer": "int", "number": "float", "boolean": "bool", "string": "str", "name": "str", "number[3]": "list[float]",
         "integer[2]": "list[int]", "object": "dict"}
MOST_VALUES = 20
SKIP = {"hello", "subscribe", "unsubscribe"}  # Connection does these


def python_name(name):
    name = name.replace(".", "_")
    return name + "_" if keyword.iskeyword(name) else name


def limit_text(value):
    return "2**53" if value == 2**53 else f"{value:.16g}"


def parameter_line(p):
    unit = f" [{p['unit']}]" if p.get("unit") else ""
    # Long lists (models, parameters) are the daemon's, not the page's: `describe` tells them.
    values = "; one of " + ", ".join(p["values"]) if 0 < len(p.get("values", [])) <= MOST_VALUES else ""
    limits = ""
    if "min" in p or "max" in p:
        limits = "; " + " to ".join(limit_text(p[end]) if end in p else "any" for end in ("min", "max"))
    default = f"; left out: {p['default']}" if p.get("default") else ""
    return f"{python_name(p['name'])}: {p['description']}{unit}{values}{limits}{default}."


def method_lines(m):
    params = sorted(m["params"], key=lambda p: not p.get("required"))
    words = ["self"]
    for p in params:
        kind = TYPES.get(p["type"], "object")
        words.append(f"{python_name(p['name'])}: {kind}" + ("" if p.get("required") else " | None = None"))
    result = "Job" if m["job"] else "dict"
    yield f"    def {python_name(m['name'])}({', '.join(words)}) -> {result}:"
    text = [m["description"][0].upper() + m["description"][1:] + "."]
    text += [parameter_line(p) for p in params]
    text.append("Returns a Job." if m["job"] else f"Returns {m['result']}.")
    wrapped = [line for part in text for line in textwrap.wrap(part, 108, subsequent_indent="    ")]
    yield '        """' + wrapped[0] + ("" if len(wrapped) > 1 else '"""')
    for line in wrapped[1:]:
        yield "        " + line
    if len(wrapped) > 1:
        yield '        """'
    given = ", ".join(f'"{p["name"]}": {python_name(p["name"])}' for p in params)
    yield f'        return self._{"job" if m["job"] else "ask"}("{m["name"]}", {{{given}}})'


def main():
    table = json.load(sys.stdin)
    print('"""The methods of the daemon. Made by make_methods.py from the method table; change that, not this file."""')
    print("\nfrom .connection import Job\n\n")
    print("class Methods:")
    print('    """Every method of the daemon; arguments left out (None) are not sent."""\n')
    print("    def _ask(self, method, params):")
    print("        return self.call(method, **{name: value for name, value in params.items() if value is not None})\n")
    print("    def _job(self, method, params):")
    print('        return Job(self, self._ask(method, params)["job"])')
    for m in table["methods"]:
        if m["name"] in SKIP:
            continue
        print()
        for line in method_lines(m):
            print(line)


if __name__ == "__main__":
    main()
