// The compiled bodies of jvp-inl.h.
#include <pliant/body/jvp-inl.h>
