// The compiled function bodies of multibody-inl.h.
#include <pliant/body/multibody-inl.h>
