/* Poses, keyframes and fictitious veins, as parameter files: whatever the bytes, veins keep their lengths and all is finite, or there is an error. */
#include "../unit/hand_skeleton.h"
#include "fuzz.h"
#include "lib/shape.h"
#include "shape/pose.h"
#include "lib/settings.h"
#include "sound.h"

static void bend(const Skeleton *s, const Params *p)
{
    GError *error = NULL;
    PoseDef def = settings_pose(p, 1);
    Pose *pose = pose_new(s);
    bool ok = pose_apply(pose, &def, &error);
    fuzz_check_error(ok, &error, POSE_ERROR, 0);
    for (uint32_t i = 0; ok && i < s->n_nodes; i++) {
        Vec3 a = pose->place[i];
        require(isfinite(a.x) && isfinite(a.y) && isfinite(a.z));
        if (s->hinge[i] == NO_PARENT)
            continue;
        double flat = vec_dist(s->rest[i], s->rest[s->hinge[i]]);
        require(fabs(vec3_dist(a, pose->place[s->hinge[i]]) - flat) <= 1e-9 * (1.0 + flat));
    }
    pose_free(pose);
}

static void animate(const Skeleton *s, const Params *p)
{
    GError *error = NULL;
    Keyframe *frame = NULL;
    uint32_t n = 0;
    bool ok = settings_keyframes(p, &frame, &n, &error);
    fuzz_check_error(ok, &error, SETTINGS_ERROR, PARAM_ERROR, 0);
    for (uint32_t i = 0; ok && i < n; i++) {
        require(isfinite(frame[i].time) && (i == 0 || frame[i].time > frame[i - 1].time));
        if (i < 4)
            bend(s, frame[i].params);
    }
    if (ok)
        keyframes_free(frame, n);
}

static Skeleton *draw_in(const Skeleton *s, const Params *p)
{
    GError *error = NULL;
    Vec2 *point = NULL;
    uint32_t *count = NULL, n = 0;
    Skeleton *with = NULL;
    bool ok = settings_fictitious(p, 100.0, &point, &count, &n, &error);
    fuzz_check_error(ok, &error, SETTINGS_ERROR, 0);
    if (ok && n) {
        with = skeleton_add_fictitious(s, point, count, n, 100.0, &error);
        fuzz_check_error(with != NULL, &error, SKELETON_ERROR, 0);
    }
    g_free(point);
    g_free(count);
    return with;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GError *error = NULL;
    Params *p = params_parse((const char *)data, size, "fuzz.ini", &error);
    fuzz_check_error(p != NULL, &error, PARAM_ERROR, 0);
    if (!p)
        return 0;
    Skeleton *s = hand_pinnate(3, 1);
    s->least = 0.25;
    Skeleton *with = draw_in(s, p);
    bend(with ? with : s, p);
    animate(s, p);
    skeleton_free(with);
    hand_free(s);
    params_free(p);
    return 0;
}
