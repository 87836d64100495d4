/* Tips of real leaves that were marked by hand must be among the characteristic points. Scans that are not here are skipped (real_scan.h). */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "real_scan.h"
#include "scan/fang.h"

enum { MOST = 24 };

/* Scans at 300 dpi blur pale tips, which in red are as bright as the paper: there the contour ends 10 to 14 pixels short of some marks already, and what
 * is within 20, 1 % of a leaf's length, is the tip's. Missed is one, soft and beside the petiole that lies over it.
 * Pixels of the scan, y down: the picture was cut out around each tip, enlarged four times (grape.jpg six), and the outermost pixel that is leaf read off
 * against a scale; to 2 pixels. The first five of grapevines are the lobes' tips, the first of zelkova is the leaf's, which is torn; the others are teeth.
 * Zelkova's three blunt or bitten teeth are left out. */
typedef struct {
    const char *file;
    double within; /* pixels from a mark to the nearest characteristic point */
    uint32_t most_missed;
    Vec2 mark[MOST];
} Marks;

static const Marks MARKS[] = {
    {"grape.jpg", 8.0, 0,
     {{46, 447}, {884, 390}, {102, 803}, {831, 760}, {510, 1027}, {76, 612}, {277, 866}, {690, 808}, {628, 904}, {385, 926}, {839, 542}, {838, 631},
      {154, 287}, {303, 233}, {663, 216}, {767, 269}, {432, 977}, {577, 947}, {720, 738}, {817, 314}}},
    {"grape_301.jpg", 20.0, 0,
     {{863, 1054}, {2538, 941}, {975, 1768}, {2432, 1683}, {1792, 2214}, {922, 1384}, {1325, 1893}, {2148, 1776}, {2026, 1970}, {1541, 2012},
      {2449, 1244}, {2447, 1423}, {1078, 736}, {1377, 626}, {2097, 591}, {2304, 695}, {1635, 2115}, {1924, 2053}, {2212, 1635}, {2404, 787}}},
    {"grape_303.jpg", 20.0, 1,
     {{1077, 999}, {1159, 1575}, {1721, 1884}, {2051, 1699}, {1053, 1183}, {1084, 1351}, {1357, 1537}, {1452, 1714}, {1562, 1779}, {1866, 1674},
      {1795, 1756}, {2178, 1407}, {2116, 1537}, {2245, 876}, {2031, 683}, {1257, 730}, {1108, 913}, {1756, 1812}, {2150, 768}, {1911, 660}}},
    {"zelkova.jpg", 20.0, 0,
     {{3313, 2074}, {1666, 673}, {1877, 738}, {2081, 838}, {2272, 948}, {2450, 1070}, {2562, 1215}, {2704, 1328}, {3015, 1752}, {3076, 1890},
      {3163, 1971}, {1212, 957}, {1302, 1141}, {1424, 1354}, {1561, 1514}, {1717, 1659}, {1857, 1788}, {2000, 1913}, {2171, 1978}, {2544, 2098},
      {3207, 2229}}},
};

static FangProfile *captured(const Scan *s)
{
    FangDef def = fang_def_default();
    GError *error = NULL;
    FangProfile *p = fang_capture(s, &def, &error);
    g_assert_no_error(error);
    return p;
}

static void test_marks(gconstpointer user)
{
    const Marks *m = user;
    Scan *s = real_scan(m->file);
    if (!s)
        return;
    FangProfile *p = captured(s);
    uint32_t n = 0, missed = 0;
    double sum = 0.0, most = 0.0;
    for (; n < MOST && m->mark[n].x > 0.0; n++) {
        Vec2 mark = vec2(m->mark[n].x + 0.5, s->height - m->mark[n].y - 0.5);
        double corner = HUGE_VAL, contour = vec_dist(polygon_nearest(p->contour, mark, NULL), mark);
        for (guint k = 0; k < p->corners->len; k++)
            corner = MIN(corner, vec_dist(p->contour->v[g_array_index(p->corners, Corner, k).at], mark));
        if (!(corner <= m->within)) {
            missed++;
            g_test_message("%s: the tip at %g,%g is %.1f pixels from the next characteristic point, %.1f from the contour", m->file, m->mark[n].x, m->mark[n].y,
                           corner, contour);
        } else {
            sum += corner;
            most = MAX(most, corner);
        }
    }
    g_test_message("%s: %u of %u tips are among %u characteristic points, off by %.1f pixels in the mean, %.1f at most", m->file, n - missed, n,
                   p->corners->len, sum / (n - missed), most);
    g_assert_cmpuint(missed, <=, m->most_missed);
    fang_profile_free(p);
    scan_free(s);
}

/* The petiole of grape_303 lies over the blade, as pale as paper: the contour has no slit along it. Marked are places on it, x and y down. */
static void test_petiole(void)
{
    static const Vec2 on[] = {{1800, 920}, {1850, 926}, {1900, 935}, {1925, 940}};
    Scan *s = real_scan("grape_303.jpg");
    if (!s)
        return;
    FangProfile *p = captured(s);
    for (guint i = 0; i < G_N_ELEMENTS(on); i++)
        g_assert_cmpfloat(polygon_depth(p->contour, vec2(on[i].x + 0.5, s->height - on[i].y - 0.5)), >, 5.0);
    fang_profile_free(p);
    scan_free(s);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    for (guint i = 0; i < G_N_ELEMENTS(MARKS); i++) {
        char *path = g_strdup_printf("/tips/%.*s", (int)(strchr(MARKS[i].file, '.') - MARKS[i].file), MARKS[i].file);
        g_test_add_data_func(path, &MARKS[i], test_marks);
        g_free(path);
    }
    g_test_add_func("/tips/petiole", test_petiole);
    return g_test_run();
}
