#!/usr/bin/env python3
"""Copies README.md, CHANGELOG.md, docs/ and the pages that they link to into a folder, in the form that Doxygen
reads.

    doxygen_pages.py OUT

Doxygen 1.9 does not resolve links to headings, links to pages with equal names, or images. In the copies, every page
and heading has a label, and links refer to these labels. Images are copied to OUT/html. A link to any other file of the
repository is replaced by its text. Fails if a link refers to a page, heading or file that does not exist.
"""

import glob
import os
import re
import shutil
import sys

ANCHOR = r'<a id="(\w+)"></a>'
LINK = re.compile(r"(!?)\[((?:[^][]|\[[^]]*\])*)\]\(([^)\s]+)\)")
problems = []


def label_of(page):
    return "index" if page == "README.md" else "page_" + re.sub(r"\W", "_", page[: -len(".md")])


def blocks(text):
    """Yields each line of a page, together with True if the line is prose and False if it is code."""
    code = False
    for line in text.split("\n"):
        fence = re.match(r"\s*```", line)
        yield line, not code and not fence
        code = code != bool(fence)


def anchors_of(page):
    """Returns the anchors of the headings below a page's title, by line number. If the page does not define an anchor
    for a heading, the anchor is the one that GitHub generates."""
    out = {}
    with open(page, encoding="utf-8") as file:
        for number, (line, prose) in enumerate(blocks(file.read())):
            if prose and (heading := re.match(r"##+ +(.*)", line)):
                own = re.match(ANCHOR, heading.group(1))
                text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading.group(1))
                out[number] = own.group(1) if own else re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")
    return out


def converted(page, pages, out):
    anchors = anchors_of(page)

    def link(found):
        image, text, target = found.groups()
        if re.match(r"[a-z]+:", target):
            return found.group(0)
        path, _, anchor = target.partition("#")
        path = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        if not os.path.exists(path):
            problems.append(f"{page}: links to {target}, which does not exist")
        elif image:
            os.makedirs(os.path.join(out, "html", os.path.dirname(path)), exist_ok=True)
            shutil.copy(path, os.path.join(out, "html", path))
            return f"![{text}]({path})"
        elif path.endswith(".md"):
            if path not in pages:
                pages.append(path)
            if anchor and anchor not in anchors_of(path).values():
                problems.append(f"{page}: links to {target}, a heading that does not exist")
            return f"[{text}](@ref {label_of(path)}{'_' + anchor if anchor else ''})"
        return text if text.strip("`") in path else f"{text} (`{path}`)"

    parts = [(True, [])]  # runs of lines that are prose or code; a link may extend over two lines
    with open(page, encoding="utf-8") as file:
        for number, (line, prose) in enumerate(blocks(file.read())):
            if number == 0 and page != "README.md":
                line = line.replace("`", "") + f" {{#{label_of(page)}}}"
            elif number in anchors:
                line = re.sub(ANCHOR, "", line) + f" {{#{label_of(page)}_{anchors[number]}}}"
            if prose != parts[-1][0]:
                parts.append((prose, []))
            parts[-1][1].append(line)
    texts = ["\n".join(lines) for _, lines in parts]
    return "\n".join(LINK.sub(link, text) if prose else text for (prose, _), text in zip(parts, texts))


def main():
    out = sys.argv[1]
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    folder = os.path.join(out, "pages")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    pages = ["README.md", "docs/README.md", *sorted(glob.glob("docs/*.md") + glob.glob("docs/tutorials/*.md"))]
    pages = list(dict.fromkeys(pages))
    for page in pages:  # grows while links are followed
        with open(os.path.join(folder, label_of(page) + ".md"), "w", encoding="utf-8") as file:
            file.write(converted(page, pages, out))
    for problem in problems:
        print(f"doxygen_pages.py: {problem}", file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
