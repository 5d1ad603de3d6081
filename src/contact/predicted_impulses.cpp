// The library's instance of the function bodies in <pliant/contact/predicted_impulses-inl.h>.
#include <pliant/contact/predicted_impulses-inl.h>
