#!/usr/bin/python3
"""Reads a GraphML file with NetworkX, as a reader would, and prints what it finds.

    check_graphml.py FILE

One "name value" a line: class, directed, nodes, edges, meshedness (alpha, of the graph without directions), acyclic, for each
attribute of the graph its Python type and value, and for each attribute node.NAME or edge.NAME its type and, of numeric ones,
the sum, in repr form.
Exits with 77 (skipped) without NetworkX.
"""
import math
import sys

try:
    import networkx as nx
except ImportError:
    sys.exit(77)


def attributes(rows):
    """Types and exact sums of the attributes; every row must have all of them."""
    types, values = {}, {}
    rows = list(rows)
    for row in rows:
        for key, value in row.items():
            types.setdefault(key, set()).add(type(value).__name__)
            values.setdefault(key, []).append(value)
    for key in sorted(types):
        if len(values[key]) != len(rows):
            sys.exit(f"attribute {key} is missing in {len(rows) - len(values[key])} places")
        numeric = not any(isinstance(v, str) for v in values[key])
        yield key, "/".join(sorted(types[key])), math.fsum(values[key]) if numeric else None


def main(path):
    graph = nx.read_graphml(path)
    n, m = graph.number_of_nodes(), graph.number_of_edges()
    parts = nx.number_connected_components(graph.to_undirected())
    print("class", type(graph).__name__)
    print("directed", graph.is_directed())
    print("nodes", n)
    print("edges", m)
    print("meshedness", repr((m - n + parts) / (2 * n - 5)) if n > 2 else "none")
    print("acyclic", nx.is_directed_acyclic_graph(graph))
    for key in sorted(graph.graph.keys() - {"node_default", "edge_default"}):  # NetworkX's own
        print(f"graph.{key}", type(graph.graph[key]).__name__, graph.graph[key])
    rows = {"node": (d for _, d in graph.nodes(data=True)), "edge": (d for _, _, d in graph.edges(data=True))}
    for domain, data in rows.items():
        for key, kind, total in attributes(data):
            print(f"{domain}.{key}", kind, "" if total is None else repr(total))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
