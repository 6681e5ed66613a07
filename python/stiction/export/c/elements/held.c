/* What a resting contact answers to an effort: the effort, at most its break-away level. */
static real held(real effort, real greatest)
{
    if (effort > greatest) {
        return greatest;
    }
    return effort < -greatest ? -greatest : effort;
}
