#include <setjmp.h>
#include <string.h>

#include "scan/scan_file.h"

#include <jpeglib.h>
#include <jerror.h>

enum { MAX_PASSES = 500 }; /* a progressive file of more only means to keep us busy */

/* Everything that libjpeg's error jump must leave behind whole. */
typedef struct {
    struct jpeg_error_mgr manager; /* first, for its callbacks get nothing else */
    struct jpeg_decompress_struct jpeg;
    struct jpeg_progress_mgr progress;
    jmp_buf jump;
    ScanFile *f;
    Scan *scan;
    uint8_t *row; /* of CMYK */
    ScanError kind;
    bool no_memory;
    char message[JMSG_LENGTH_MAX];
    GError *error;
} Reader;

G_NORETURN static void on_error(j_common_ptr jpeg)
{
    Reader *r = (Reader *)jpeg->err;
    jpeg->err->format_message(jpeg, r->message);
    int code = jpeg->err->msg_code;
    bool unknown = code == JERR_BAD_PRECISION || code == JERR_SOF_UNSUPPORTED || code == JERR_ARITH_NOTIMPL || code == JERR_CONVERSION_NOTIMPL;
    r->no_memory = code == JERR_OUT_OF_MEMORY;
    r->kind = unknown ? SCAN_ERROR_KIND : SCAN_ERROR_DAMAGED;
    longjmp(r->jump, 1);
}

/* libjpeg makes up what is missing of a damaged file and only warns; here that is an error. */
static void on_message(j_common_ptr jpeg, int level)
{
    int code = jpeg->err->msg_code;
    bool harmless = code == JWRN_EXTRANEOUS_DATA || code == JWRN_ADOBE_XFORM || code == JWRN_JFIF_MAJOR || code == JWRN_BOGUS_PROGRESSION;
    if (level < 0 && !harmless)
        on_error(jpeg);
}

static void on_progress(j_common_ptr jpeg)
{
    Reader *r = (Reader *)jpeg->err;
    if (r->jpeg.input_scan_number <= MAX_PASSES)
        return;
    g_snprintf(r->message, sizeof r->message, "more than %d passes", MAX_PASSES);
    r->kind = SCAN_ERROR_DAMAGED;
    longjmp(r->jump, 1);
}

/* What JFIF says about the resolution goes before what Exif says. */
static void read_facts(Reader *r)
{
    const struct jpeg_decompress_struct *j = &r->jpeg;
    double mm = j->density_unit == 1 ? 25.4 : j->density_unit == 2 ? 10.0 : 0.0;
    if (j->saw_JFIF_marker && mm > 0.0) {
        r->f->across_mm = j->X_density / mm;
        r->f->down_mm = j->Y_density / mm;
    }
    for (jpeg_saved_marker_ptr m = j->marker_list; m; m = m->next)
        if (m->marker == JPEG_APP0 + 1 && m->data_length > 6 && !memcmp(m->data, "Exif\0", 6))
            scan_file_exif(r->f, m->data + 6, m->data_length - 6);
}

/* Adobe's programs store CMYK as its complement. */
static void cmyk_to_rgb(const uint8_t *in, uint8_t *out, uint32_t width, bool complement)
{
    for (uint32_t x = 0; x < width; x++, in += 4, out += 3) {
        unsigned k = complement ? in[3] : 255u - in[3];
        for (int c = 0; c < 3; c++)
            out[c] = (uint8_t)(((complement ? in[c] : 255u - in[c]) * k + 127) / 255);
    }
}

static void read_row(Reader *r, uint8_t *out)
{
    struct jpeg_decompress_struct *j = &r->jpeg;
    JSAMPROW row = r->row ? r->row : out;
    jpeg_read_scanlines(j, &row, 1);
    if (r->row)
        cmyk_to_rgb(r->row, out, r->scan->width, j->saw_Adobe_marker);
}

static gboolean decode(Reader *r)
{
    struct jpeg_decompress_struct *j = &r->jpeg;
    if (setjmp(r->jump))
        return FALSE;
    jpeg_create_decompress(j);
    r->progress.progress_monitor = on_progress;
    j->progress = &r->progress;
    jpeg_stdio_src(j, r->f->file);
    jpeg_save_markers(j, JPEG_APP0 + 1, 0xFFFF);
    jpeg_read_header(j, TRUE);
    bool cmyk = j->jpeg_color_space == JCS_CMYK || j->jpeg_color_space == JCS_YCCK, grey = j->jpeg_color_space == JCS_GRAYSCALE;
    j->out_color_space = cmyk ? JCS_CMYK : grey ? JCS_GRAYSCALE : JCS_RGB;
    j->dct_method = JDCT_ISLOW; /* the same bits with and without vector instructions */
    r->scan = scan_file_new(r->f, j->image_width, j->image_height, grey ? 1 : 3, 8, &r->error);
    if (!r->scan)
        return FALSE;
    r->row = cmyk ? g_malloc((gsize)j->image_width * 4) : NULL;
    jpeg_start_decompress(j);
    gsize row = (gsize)r->scan->width * r->scan->channels;
    while (j->output_scanline < j->output_height)
        read_row(r, (uint8_t *)r->scan->px + j->output_scanline * row);
    read_facts(r);
    jpeg_finish_decompress(j);
    return TRUE;
}

Scan *scan_read_jpeg(ScanFile *f, GError **error)
{
    Reader *r = g_new0(Reader, 1); /* on the heap, so that the jump leaves it alone */
    r->f = f;
    r->jpeg.err = jpeg_std_error(&r->manager);
    r->manager.error_exit = on_error;
    r->manager.emit_message = on_message;
    gboolean ok = decode(r);
    jpeg_destroy_decompress(&r->jpeg);
    Scan *scan = r->scan;
    if (!ok) {
        scan_free(scan);
        scan = NULL;
        if (r->error)
            g_propagate_error(error, r->error);
        else if (r->no_memory)
            scan_file_no_memory(f, error);
        else if (ferror(f->file))
            g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_IO, "can't read %s", f->path);
        else
            scan_file_error(f, r->kind, error, "%s JPEG image: %s", r->kind == SCAN_ERROR_DAMAGED ? "damaged" : "can't read this", r->message);
    }
    g_free(r->row);
    g_free(r);
    return scan;
}
