/* Loops over RADIANCE's library calls, so that a measurement is of the calls and not of Python around them.
 * SDValue is larger than its first member; a block of 64 doubles holds it in every release. */

typedef int (*eval_call)(double *value, const double *out, const double *in, const void *bsdf);
typedef int (*sample_call)(double *value, double *direction, double random, int flags, const void *bsdf);

/* value[k] = f(out[k], in[k]), photopic. Returns the number of errors. */
long eval_loop(eval_call call, const void *bsdf, const double *out, const double *in, double *value, long n)
{
    double found[64];
    long errors = 0;
    for (long k = 0; k < n; k++) {
        found[0] = 0.0;
        errors += call(found, out + 3 * k, in + 3 * k, bsdf) != 0;
        value[k] = found[0];
    }
    return errors;
}

/* direction[k], the incident one, is overwritten by the sampled one; weight[k] is the albedo. */
long sample_loop(sample_call call, const void *bsdf, double *direction, const double *random, int flags, double *weight,
                 long n)
{
    double found[64];
    long errors = 0;
    for (long k = 0; k < n; k++) {
        found[0] = 0.0;
        errors += call(found, direction + 3 * k, random[k], flags, bsdf) != 0;
        weight[k] = found[0];
    }
    return errors;
}
