#!/usr/bin/env python3
"""Replaces the text between two marks of a document by a file: splice.py DOCUMENT MARK FILE

The marks are comments, "<!-- MARK -->" and "<!-- end of MARK -->", each on a line of its own.
"""

import sys


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    document, mark, file = sys.argv[1:]
    with open(document, encoding="utf-8") as source:
        text = source.read()
    begin, end = f"<!-- {mark} -->\n", f"<!-- end of {mark} -->\n"
    if text.count(begin) != 1 or text.count(end) != 1:
        sys.exit(f"splice.py: {document}: marks missing (got {text.count(begin)} of {begin.strip()}; expected one of each)")
    with open(file, encoding="utf-8") as source:
        inside = source.read()
    head, rest = text.split(begin)
    tail = rest.split(end)[1]
    with open(document, "w", encoding="utf-8") as target:
        target.write(head + begin + "\n" + inside.strip() + "\n\n" + end + tail)


if __name__ == "__main__":
    main()
