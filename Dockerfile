# Slowdrift in one image: `slowdrift serve`, `slowdrift worker`, `slowdrift migrate` are its commands (docker-compose.yml).
# Pinned by tag and digest, see docker-compose.yml; renew both together.
ARG BASE=python:3.12.11-slim-bookworm@sha256:519591d6871b7bc437060736b9f7456b8731f1499a57e22e6c285135ae657bf7
FROM ${BASE} AS build
WORKDIR /src
COPY pyproject.toml README.md requirements.lock ./
COPY solver solver
COPY store store
COPY worker worker
COPY api api
COPY frontend frontend
COPY cli cli
COPY slowdrift_client slowdrift_client
COPY examples examples
RUN python -m venv /opt/slowdrift && /opt/slowdrift/bin/pip install --no-cache-dir -r requirements.lock && \
    /opt/slowdrift/bin/pip install --no-cache-dir --no-deps --no-build-isolation .

FROM ${BASE}
RUN useradd --create-home --uid 10001 slowdrift && install -d -o slowdrift /data /cache
COPY --from=build /opt/slowdrift /opt/slowdrift
ENV PATH=/opt/slowdrift/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    OPENBLAS_NUM_THREADS=1 \
    OMP_NUM_THREADS=1 \
    NUMBA_CACHE_DIR=/cache \
    SLOWDRIFT_DATA_DIR=/data
USER slowdrift
# the kernels are compiled once, into the image
RUN python -c "import solver.run as run; run.warm_up(); run.warm_up_time_domain()"
WORKDIR /data
EXPOSE 8000
CMD ["slowdrift", "serve", "--host", "0.0.0.0", "--setup", "--log", "here"]
