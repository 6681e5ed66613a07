
void stiction_init(stiction_state *s)
{
    *s = (stiction_state){0};
#ifdef LAW_INIT
    law_init(s);
#endif
#each init
    EFFECT_init(s);
#end
}
