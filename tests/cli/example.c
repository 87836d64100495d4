/* Grows a leaf through libvenation and prints its widest vein: gcc example.c $(pkg-config --cflags --libs venation) */
#include <stdio.h>
#include <venation.h>

int main(int argc, char **argv)
{
    GError *error = NULL;
    VenParams *params = argc > 1 ? ven_params_load(argv[1], &error) : ven_params_new();
    VenLeaf *leaf = params ? ven_grow(params, 1, NULL, &error) : NULL;
    if (!leaf) {
        fprintf(stderr, "%s\n", error->message);
        return 1;
    }
    VenEdge edge, widest = {0};
    for (uint32_t i = 0; i < ven_leaf_edges(leaf); i++, widest = edge.width > widest.width ? edge : widest)
        ven_leaf_edge(leaf, i, &edge);
    printf("%u nodes, %u edges, widest vein %.1f segments\n", ven_leaf_nodes(leaf), ven_leaf_edges(leaf), widest.width);
    ven_leaf_free(leaf);
    ven_params_free(params);
    return 0;
}
