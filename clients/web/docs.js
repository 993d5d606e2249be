// The REST API's documentation, from the service's own OpenAPI description; nothing is fetched from elsewhere.
globalThis.SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#docs",
  deepLinking: true,
  validatorUrl: null,
  onComplete: () => {
    document.documentElement.dataset.docs = "ready";
  },
});
