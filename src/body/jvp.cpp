// The compiled function bodies of jvp-inl.h.
#include <pliant/body/jvp-inl.h>
