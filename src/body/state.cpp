// The compiled function bodies of state-inl.h.
#include <pliant/body/state-inl.h>
