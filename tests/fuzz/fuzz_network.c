/* Networks: whatever the bytes, there is a sound network that writes and reads back alike, or an error. */
#include "export/export.h"
#include "fuzz.h"
#include "import/import.h"
#include "sound.h"

static Network *read_network(const char *text, gsize length)
{
    WidthDef widths = width_def_default();
    GError *error = NULL;
    Network *net = import_graphml_text(text, length, "fuzz.graphml", &widths, &error);
    fuzz_check_error(net != NULL, &error, IMPORT_ERROR, 0);
    return net;
}

static char *write_network(const Network *net)
{
    const char *path = fuzz_file("network.graphml", "", 0);
    char *text = NULL;
    require(export_graphml(net, path, NULL) && g_file_get_contents(path, &text, NULL, NULL));
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Network *net = read_network((const char *)data, size);
    if (!net)
        return 0;
    sound_network(net);
    char *once = write_network(net);
    Network *back = read_network(once, strlen(once));
    require(back != NULL || net->margin != NULL); /* a margin may come to meet itself when it is rounded */
    if (back) {
        sound_network(back);
        char *twice = write_network(back);
        require(strcmp(once, twice) == 0);
        g_free(twice);
    }
    network_free(back);
    g_free(once);
    network_free(net);
    return 0;
}
