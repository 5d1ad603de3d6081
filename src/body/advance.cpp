// The compiled function bodies of advance-inl.h.
#include <pliant/body/advance-inl.h>
