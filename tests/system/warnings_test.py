#!/usr/bin/env python3
"""Every code of a warning in the source stands in docs/warnings.md, and every code there is in the source.

warnings_test.py SOURCE
"""

import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
# A warning is added to a list, or returned: {"code", share or text ...}.
ADDED = re.compile(
    r'\b(?:warnings|repairs|out)\.(?:push_back|emplace_back)\(\s*\{?\s*(?:\.code = )?"([a-z_]+)",\s*(?!nlohmann|json)'
    r'|\breturn (?:\w*Warning)?\{\s*"([a-z_]+)",\s*(?:\w*share|fmt::format)'
    r'|\.code = "([a-z_]+)"'
    r'|\b(?:Warning|ForeignRepair|\w+Warning) \w+\{\s*"([a-z_]+)"'
)
FOLDERS = ["apps", "compare", "focus", "motionblur", "pictures", "planner", "sweep", "tracer"]

text = {
    path: path.read_text()
    for folder in FOLDERS
    for path in sorted((source / folder).rglob("*"))
    if path.suffix in (".cpp", ".h")
}
found = {}
for path, code in text.items():
    for match in ADDED.finditer(code):
        found.setdefault(next(filter(None, match.groups())), path.relative_to(source))
page = (source / "docs/warnings.md").read_text()
rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `")]
documented = {code for row in rows for code in re.findall(r"`([a-z_]+)`", row)}

errors = [f"{path}: the warning {code} is not in docs/warnings.md" for code, path in found.items() if code not in documented]
errors += [
    f"docs/warnings.md: the warning {code} is not in the source"
    for code in sorted(documented)
    if not any(f'"{code}"' in code_text for code_text in text.values())
]
print("\n".join(errors) or f"{len(found)} warnings found, {len(documented)} documented")
sys.exit(bool(errors) or len(found) < len(documented) // 2)
